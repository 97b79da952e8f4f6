#include "host_sim/sweep/result_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::sweep {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view name_begin = "results-", name_end = ".jsonl";

std::string header_of(const CaseSet& cases, const Shard& shard) {
  return ordered_json{{"cases", cases.count}, {"fingerprint", cases.fingerprint}, {"shard", shard.text()}}.dump();
}

[[noreturn]] void fail_to_write(const std::filesystem::path& file, int error) {
  throw firmware::OutputError(file.string(), std::string("cannot be written (") + std::strerror(error) + ")",
                              "a folder with room for the results");
}

std::optional<std::uint64_t> whole_member(const ordered_json& json, const char* key) {
  if (!json.is_object() || !json.contains(key) || !json[key].is_number_unsigned()) return std::nullopt;
  return json[key].get<std::uint64_t>();
}

/// false: at the end of the file, or at a last line without an end.
bool read_whole_line(std::istream& stream, std::string& line) { return std::getline(stream, line) && !stream.eof(); }

/// A shard makes its file before it writes the first line: another that starts beside it may look in between.
bool has_begun(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  return !stream || read_whole_line(stream, line);  // one that cannot be opened is an error of its reader
}

}  // namespace

ResultFile::ResultFile(const std::filesystem::path& folder, const CaseSet& cases, const Shard& shard)
    : path_(folder / (std::string(name_begin) + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) +
                      std::string(name_end))) {
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail_to_write(path_, errno);
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      throw firmware::OutputError(path_.string(), "is being written by another process", "one process for each shard");
    }
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail_to_write(path_, errno);
    const std::string header = header_of(cases, shard);
    const auto size = static_cast<std::uint64_t>(status.st_size);
    // A first line without an end: the process was killed while it wrote it.
    std::string begin(std::min<std::uint64_t>(size, header.size() + 1), '\0');
    if (!begin.empty() && ::pread(descriptor_, begin.data(), begin.size(), 0) != static_cast<ssize_t>(begin.size())) {
      fail_to_write(path_, errno);
    }
    if (header.starts_with(begin) && begin.size() <= header.size()) {
      if (::ftruncate(descriptor_, 0) != 0) fail_to_write(path_, errno);
      write_whole(header + "\n");
      return;
    }
    ResultReader reader(path_);
    reader.demand(cases);
    while (reader.next()) {
    }
    if (reader.whole() < size && ::ftruncate(descriptor_, static_cast<off_t>(reader.whole())) != 0) {
      fail_to_write(path_, errno);
    }
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

ResultFile::~ResultFile() { ::close(descriptor_); }

void ResultFile::append(std::string_view line) { write_whole(std::string(line) + "\n"); }

void ResultFile::write_whole(std::string_view bytes) {
  const off_t before = ::lseek(descriptor_, 0, SEEK_END);
  const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
  if (written == static_cast<ssize_t>(bytes.size())) return;
  const int error = written < 0 ? errno : ENOSPC;
  if (written > 0 && before >= 0 && ::ftruncate(descriptor_, before) != 0) fail_to_write(path_, errno);
  fail_to_write(path_, error);
}

ResultReader::ResultReader(const std::filesystem::path& file) : name_(file.string()), stream_(file, std::ios::binary) {
  if (!stream_) throw firmware::InputError(name_, 0, "cannot be opened", "a readable file of results");
  std::string line;
  const bool there = read_line(line);
  const ordered_json json = there ? ordered_json::parse(line, nullptr, false) : ordered_json();
  const auto count = whole_member(json, "cases");
  if (!count || !json.contains("fingerprint") || !json["fingerprint"].is_string()) {
    throw firmware::InputError(name_, 1, "is no file of results", "a first line with \"cases\" and \"fingerprint\"");
  }
  cases_ = {*count, json["fingerprint"].get<std::string>()};
}

void ResultReader::demand(const CaseSet& cases) const {
  if (cases_.count == cases.count && cases_.fingerprint == cases.fingerprint) return;
  throw firmware::InputError(name_, 1, "belongs to another plan, rig or version of rigtwin",
                             "an empty folder, or results of one plan only");
}

bool ResultReader::read_line(std::string& line) {
  if (!read_whole_line(stream_, line)) return false;
  ++line_number_;
  whole_ += line.size() + 1;
  return true;
}

std::optional<ResultReader::Line> ResultReader::next() {
  Line line{0, {}};
  if (!read_line(line.text)) return std::nullopt;
  const ordered_json json = ordered_json::parse(line.text, nullptr, false);
  const auto id = whole_member(json, "id");
  if (!id) throw firmware::InputError(name_, line_number_, "is no result", "a JSON object with \"id\"");
  if (*id >= cases_.count) {
    throw firmware::InputError(name_, line_number_, "case " + std::to_string(*id) + " does not exist",
                               "an id below " + std::to_string(cases_.count));
  }
  if (last_ && *id <= *last_) {
    throw firmware::InputError(name_, line_number_,
                               *id == *last_
                                   ? "case " + std::to_string(*id) + " is there twice"
                                   : "case " + std::to_string(*id) + " stands behind " + std::to_string(*last_),
                               "ascending ids");
  }
  last_ = id;
  line.id = *id;
  return line;
}

std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(name_begin) && name.ends_with(name_end) && has_begun(entry.path()))
      files.push_back(entry.path());
  }
  if (error) throw firmware::InputError(folder.string(), 0, "cannot be listed", "a folder of results");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace host_sim::sweep
