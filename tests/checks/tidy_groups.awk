# tidy_groups.awk FOLDER=… most=… FILE… compile_commands.json -- groups of sources that can be read as one: the same compiler
# options, no name defined twice in their unnamed namespaces. Writes for each FOLDER/N.cpp, which includes them, and
# FOLDER/compile_commands.json; prints for each its path and its sources, which are given absolute.
# Without compile_commands.json, which stands last, all are compiled alike: it prints each group's sources, nothing else, for
# toolchains/together.awk. That keeps the names of a source apart that ends with its unnamed namespace, as tests do; of all others no
# constant or type is a word of another source, so that no local name seems to shadow it.
# From the sources as clang-format leaves them: what stands in the first column of an unnamed namespace defines a name.

FNR == 1 { in_unnamed = closed = 0 }

FILENAME !~ /\.json$/ {
  if (FNR == 1) files[++count] = FILENAME
  if (/^using namespace [a-z_:]*;/) opened[count] = opened[count] " " $3  # is open for all that follow
  if (closed && !/^(\/\/.*)?$/) delete apart[count]
  if (/^namespace \{/) in_unnamed = 1
  if (/^\}  \/\/ namespace$/) {
    in_unnamed = 0
    closed = apart[count] = 1
  }
  if (/^using [A-Za-z_0-9:]*::[A-Za-z_0-9]*;/) {
    name = $2
    sub(/;.*/, "", name)
    sub(/.*::/, "&=", name)  # what is meant=name: the same thing may be used by several
    names[count] = names[count] " " name
  } else if (in_unnamed && /^[A-Za-z\[]/ && !/^(template|namespace|using namespace|TEST|TYPED_TEST|INSTANTIATE)/) {
    line = $0
    while (sub(/<[^<>]*>/, "", line)) {}
    callable = line ~ /^[^{=;\[]*\(/
    sub(/ *(\(|\{| = |;|\[[^\[]*\]( =|;|\{)| : ).*/, "", line)
    sub(/.*[^A-Za-z_0-9]/, "", line)
    if (line != "") names[count] = names[count] " " files[count] "=" line
    if (!callable) values[count] = values[count] " " line
  }
  if (FOLDER == "") {
    line = $0
    sub(/\/\/.*/, "", line)
    amount = split(line, list, /[^A-Za-z_0-9]+/)
    for (n = 1; n <= amount; ++n) {
      if ((count, list[n]) in said) continue
      said[count, list[n]]
      words[count] = words[count] " " list[n]
    }
  }
  next
}

/^ *"command": / { command = $0 }
/^ *"file": / {
  file = $2
  gsub(/["]/, "", file)
  command_of[file] = command
}

# Source i and group g have no name in common that means two things.
function is_free(i, g,   n, amount, list, meant) {
  amount = split(names[i], list, " ")
  for (n = 1; n <= amount; ++n) {
    split(list[n], meant, "=")
    if ((g, meant[2]) in taken && taken[g, meant[2]] != meant[1]) return 0
  }
  amount = split(values[i], list, " ")
  for (n = 1; n <= amount; ++n) if ((g, list[n]) in word_in) return 0
  amount = split(words[i], list, " ")
  for (n = 1; n <= amount; ++n) if ((g, list[n]) in value_in) return 0
  return 1
}

END {
  for (i = 1; i <= count; ++i) {
    if (FOLDER != "" && !(files[i] in command_of)) continue  # compiled nowhere
    kind = command_of[files[i]]
    sub(/ -o .*/, "", kind)
    gsub(/ -O[0-3]/, "", kind)
    command = kind
    if (FOLDER == "" && (i in apart)) names[i] = values[i] = words[i] = opened[i] = ""
    kind = kind opened[i]
    for (g = 1; g <= groups; ++g) {
      if (kind_of[g] == kind && size[g] < most && is_free(i, g)) break
    }
    if (g > groups) {
      kind_of[groups = g] = kind
      common[g] = command
    }
    defined = split(names[i], list, " ")
    for (n = 1; n <= defined; ++n) {
      split(list[n], meant, "=")
      taken[g, meant[2]] = meant[1]
    }
    defined = split(values[i], list, " ")
    for (n = 1; n <= defined; ++n) value_in[g, list[n]]
    defined = split(words[i], list, " ")
    for (n = 1; n <= defined; ++n) word_in[g, list[n]]
    ++size[g]
    members[g] = members[g] " " files[i]
  }
  if (FOLDER == "") {
    for (g = 1; g <= groups; ++g) print substr(members[g], 2)
    exit
  }
  printf "[" > (FOLDER "/compile_commands.json")
  for (g = 1; g <= groups; ++g) {
    path = FOLDER "/" g ".cpp"
    amount = split(members[g], list, " ")
    for (n = 1; n <= amount; ++n) printf "#include \"%s\"\n", list[n] > path
    close(path)
    printf "%s\n{\"directory\": \"%s\",\n%s -c %s\",\n\"file\": \"%s\"}", (g > 1 ? "," : ""), FOLDER, common[g], path, path > (FOLDER "/compile_commands.json")
    print path members[g]
  }
  printf "\n]\n" > (FOLDER "/compile_commands.json")
}
