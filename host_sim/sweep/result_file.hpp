// The results of one shard: a line a case, each whole or not there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/sweep/shard.hpp"

namespace host_sim::sweep {

/// A set of numbered cases, 0 … count − 1, and the text that says which: equal texts, equal results.
struct CaseSet {
  std::uint64_t count = 0;
  std::string fingerprint;  ///< SHA-256 of all that the results depend on
};

/// The file of a shard in a results folder: results-INDEX-of-COUNT.jsonl.
///
///   line 1      {"cases": …, "fingerprint": "…", "shard": "i/n"}
///   then        {"id": …, …} for each case that is done, ids ascending
///
/// A line is written by one write() that ends with the line's end. A process that is killed leaves at most one line
/// without an end, the last; opening the file again cuts it off. A disk that is full leaves no part of a line either.
class ResultFile {
 public:
  /// Opens or continues the file of a shard. InputError if it belongs to other cases, or if its lines are damaged;
  /// OutputError if it cannot be written or another process writes it now.
  ResultFile(const std::filesystem::path& folder, const CaseSet& cases, const Shard& shard);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  /// Appends a line (without its end). OutputError if it cannot be written; then no part of it stays.
  void append(std::string_view line);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  void write_whole(std::string_view bytes);

  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Reads such a file line by line.
class ResultReader {
 public:
  /// InputError without a valid first line.
  explicit ResultReader(const std::filesystem::path& file);

  [[nodiscard]] const CaseSet& cases() const { return cases_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// InputError if the file belongs to other cases.
  void demand(const CaseSet& cases) const;
  /// Bytes up to the end of the last whole line that was read.
  [[nodiscard]] std::uint64_t whole() const { return whole_; }

  struct Line {
    std::uint64_t id;
    std::string text;  ///< without its end
  };
  /// The next line; nullopt at the end, or at a last line without an end, which does not count. InputError for a line
  /// that is no result, for an id beyond the cases, or one that does not ascend.
  [[nodiscard]] std::optional<Line> next();

 private:
  [[nodiscard]] bool read_line(std::string& line);

  std::string name_;
  std::ifstream stream_;
  CaseSet cases_;
  std::uint64_t whole_ = 0;
  std::size_t line_number_ = 0;
  std::optional<std::uint64_t> last_;
};

/// All result files of a folder, by name; without those that do not hold a whole first line yet: their shard has just
/// begun, or was killed as it did.
[[nodiscard]] std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder);

}  // namespace host_sim::sweep
