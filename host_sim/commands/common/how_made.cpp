#include "host_sim/commands/common/how_made.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/description/version.hpp"

namespace host_sim {
namespace {

constexpr std::array<std::string_view, 4> output_options{"--out", "--json", "--report", "--uff"};

/// The command line is one of the process.
std::vector<std::string>& words_of_command() {
  static std::vector<std::string> words;
  return words;
}

/// The first word that is no option.
std::string name_of_command() {
  const auto& words = words_of_command();
  const auto name = std::find_if(words.begin(), words.end(), [](const std::string& w) { return !w.starts_with('-'); });
  return name == words.end() ? std::string("rigtwin") : *name;
}

bool is_output(std::string_view option) {
  return std::find(output_options.begin(), output_options.end(), option) != output_options.end();
}

/// As a shell takes it.
std::string quoted(const std::string& word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=,+-@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

/// Read in pieces: a recording of an hour is a gigabyte. Empty if it cannot be read.
std::string sha256_of_file(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) return {};
  firmware::Sha256 hash;
  std::string piece(std::size_t{1} << 20U, '\0');
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())), file.gcount() > 0) {
    hash.take({piece.data(), static_cast<std::size_t>(file.gcount())});
  }
  return file.bad() ? std::string() : hash.digits();
}

void add_input(const std::string& name, std::vector<report::Origin::Input>& inputs);

/// If the file is a rig description: the tables that it names.
void add_referenced_files(const std::string& name, std::vector<report::Origin::Input>& inputs) {
  try {
    for (const auto& file : firmware::referenced_files(firmware::read_rig(name))) add_input(file.string(), inputs);
  } catch (const firmware::InputError&) {  // a recording, a plan: they name no tables
  }
}

void add_input(const std::string& name, std::vector<report::Origin::Input>& inputs) {
  std::error_code error;
  const bool known = std::any_of(inputs.begin(), inputs.end(), [&](const auto& i) { return i.file == name; });
  if (known || name.empty() || !std::filesystem::is_regular_file(name, error)) return;
  const std::string digits = sha256_of_file(name);
  if (digits.empty()) return;
  inputs.push_back({name, digits});
  add_referenced_files(name, inputs);
}

report::Origin origin() {
  report::Origin result{"rigtwin"};
  std::string option;
  for (const std::string& word : words_of_command()) {
    result.command += " " + firmware::one_line(quoted(word));
    const std::size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
    if (equals != std::string::npos) {
      if (!is_output(word.substr(0, equals))) add_input(word.substr(equals + 1), result.inputs);
    } else if (word.starts_with("--")) {
      option = word;
      continue;
    } else if (!is_output(option)) {
      add_input(word, result.inputs);
    }
    option.clear();
  }
  return result;
}

}  // namespace

void remember_command_line(int argc, const char* const* argv) {
  words_of_command().assign(argv + std::min(argc, 1), argv + argc);
}

HowMade::HowMade() : origin_(std::async(std::launch::async, origin).share()) {}

std::string HowMade::in(std::string page) const { return report::with_origin(std::move(page), origin_.get()); }

report::Origin origin_of(std::string command, const std::vector<std::string>& files) {
  report::Origin result{std::move(command)};
  for (const std::string& file : files) add_input(file, result.inputs);
  return result;
}

std::string json_text(const report::Origin& origin, const std::string& schema, const nlohmann::ordered_json& result) {
  nlohmann::ordered_json inputs = nlohmann::ordered_json::array();
  for (const report::Origin::Input& input : origin.inputs) {
    inputs.push_back({{"name", input.file}, {"sha256", input.sha256}});
  }
  nlohmann::ordered_json text{
      {"schema", schema}, {"version", firmware::version}, {"command", origin.command}, {"inputs", std::move(inputs)}};
  text.update(result);
  return text.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string HowMade::json(const nlohmann::ordered_json& result) const {
  return json_text(origin_.get(), "rigtwin/" + name_of_command() + "/1", result);
}

std::string with_how_made(std::string page) { return HowMade().in(std::move(page)); }

std::string json_text(const nlohmann::ordered_json& result) { return HowMade().json(result); }

}  // namespace host_sim
