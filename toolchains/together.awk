# together.awk OUT=… FILE… -- the files as one text in OUT, which says where each line comes from. The unnamed namespace with which a
# file ends, as those of tests do, gets a namespace of its own inside: its names are nobody else's.
function flush(   n, last) {
  for (last = amount; last > 0 && lines[last] ~ /^(\/\/.*)?$/;) --last
  if (lines[last] == "}  // namespace") {
    for (n = last; n > 0 && lines[n] != "namespace {";) --n
    if (n > 0) {
      lines[n] = "namespace { namespace source_" number " {"
      lines[last] = "}}"
    }
  }
  for (n = 1; n <= amount; ++n) print lines[n] > OUT
  amount = 0
}

FNR == 1 {
  flush()
  ++number
  printf "#line 1 \"%s\"\n", FILENAME > OUT
}
{ lines[++amount] = $0 }
END { flush() }
