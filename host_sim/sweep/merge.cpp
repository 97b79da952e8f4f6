#include "host_sim/sweep/merge.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <queue>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"

namespace host_sim::sweep {
namespace {

using nlohmann::ordered_json;

/// Every file of a merge is open at once; the usual soft limit is 1024.
void allow_open_files(std::size_t files) {
  constexpr rlim_t others = 64;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= files + others) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, files + others);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// The lines of all files by ascending id.
class SideBySide {
 public:
  explicit SideBySide(const std::filesystem::path& folder) : folder_(folder.string()) {
    const std::vector<std::filesystem::path> files = result_files(folder);
    if (files.empty()) {
      throw firmware::InputError(folder_, 0, "holds no results", "files results-INDEX-of-COUNT.jsonl of a sweep");
    }
    allow_open_files(files.size());
    for (const std::filesystem::path& file : files) {
      readers_.push_back(std::make_unique<ResultReader>(file));
      readers_.back()->demand(cases());
    }
    for (std::size_t i = 0; i < readers_.size(); ++i) advance(i);
  }

  [[nodiscard]] const CaseSet& cases() const { return readers_.front()->cases(); }

  /// The line with the lowest id that is left.
  [[nodiscard]] std::optional<ResultReader::Line> next() {
    if (heads_.empty()) return std::nullopt;
    Head head = heads_.top();
    heads_.pop();
    if (!heads_.empty() && heads_.top().line.id == head.line.id) {
      throw firmware::InputError(
          readers_[heads_.top().reader]->name(), 0,
          "case " + std::to_string(head.line.id) + " is there, and in " + readers_[head.reader]->name() + " too",
          "each case once");
    }
    advance(head.reader);
    return std::move(head.line);
  }

 private:
  struct Head {
    ResultReader::Line line;
    std::size_t reader;
    bool operator<(const Head& other) const { return line.id > other.line.id; }  // the queue's top is the lowest
  };

  void advance(std::size_t reader) {
    if (auto line = readers_[reader]->next()) heads_.push({std::move(*line), reader});
  }

  std::string folder_;
  std::vector<std::unique_ptr<ResultReader>> readers_;
  std::priority_queue<Head> heads_;
};

using TakeLine = std::function<void(const ResultReader::Line&)>;

/// Goes through all lines and shows each to `look`; at the end nothing is missing and nothing is there twice.
void prove_complete(const std::filesystem::path& folder, const TakeLine& look) {
  SideBySide lines(folder);
  std::uint64_t expected = 0, missing = 0;
  std::optional<std::uint64_t> first;
  const auto skip_to = [&](std::uint64_t id) {
    if (expected < id && !first) first = expected;
    missing += id - expected;
    expected = id + 1;
  };
  while (const auto line = lines.next()) {
    skip_to(line->id);
    look(*line);
  }
  const std::uint64_t count = lines.cases().count;
  if (expected < count) {
    if (!first) first = expected;
    missing += count - expected;
  }
  if (!first) return;
  throw firmware::InputError(folder.string(), 0,
                             std::to_string(missing) + " of " + std::to_string(count) +
                                 " cases are missing, the first is " + std::to_string(*first),
                             "all of them: run the shards again, what is done is not computed twice");
}

CaseSet pass_on(const std::filesystem::path& folder, const TakeLine& take) {
  SideBySide lines(folder);
  while (const auto line = lines.next()) take(*line);
  return lines.cases();
}

std::string csv_cell(const ordered_json& value) {
  if (!value.is_string()) return value.dump();
  std::string cell = "\"";
  for (const char c : value.get_ref<const std::string&>()) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

}  // namespace

CaseSet merge(const std::filesystem::path& folder, const TakeLine& take) {
  prove_complete(folder, [](const ResultReader::Line&) {});
  return pass_on(folder, take);
}

void Spread::add(double value) {
  lowest = count == 0 ? value : std::min(lowest, value);
  highest = count == 0 ? value : std::max(highest, value);
  ++count;
  const double before = value - mean;
  mean += before / static_cast<double>(count);
  squares += before * (value - mean);
}

double Spread::standard_deviation() const {
  return count > 1 ? std::sqrt(squares / static_cast<double>(count - 1)) : 0.0;
}

Merged merge_into_files(const std::filesystem::path& folder) {
  Merged merged;
  merged.json = folder / "results.jsonl";
  merged.csv = folder / "results.csv";
  // Columns: the keys of the first case that did not fail, else of the first.
  std::vector<std::string> columns;
  bool complete = false;
  prove_complete(folder, [&](const ResultReader::Line& line) {
    if (complete) return;
    const ordered_json json = ordered_json::parse(line.text);
    const bool failed = json.contains("failed");
    if (!columns.empty() && failed) return;
    columns.clear();
    for (const auto& [key, value] : json.items()) columns.push_back(key);
    complete = !failed;
  });
  if (std::find(columns.begin(), columns.end(), "failed") == columns.end()) columns.emplace_back("failed");
  for (const std::string& column : columns) merged.numbers.push_back({.name = column});

  firmware::OutputFile json_file(merged.json), csv_file(merged.csv);
  std::string header;
  for (const std::string& column : columns) header += (header.empty() ? "" : ",") + column;
  csv_file.write(header + "\n");
  merged.cases = pass_on(folder, [&](const ResultReader::Line& line) {
    json_file.write(line.text + "\n");
    const ordered_json json = ordered_json::parse(line.text);
    if (json.contains("failed")) {
      if (merged.failed++ == 0) merged.first_failure = "case " + std::to_string(line.id) + ": " + json["failed"].dump();
    }
    std::string row;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c > 0) row += ',';
      if (!json.contains(columns[c])) continue;
      const ordered_json& value = json[columns[c]];
      row += csv_cell(value);
      if (value.is_number()) merged.numbers[c].add(value.get<double>());
    }
    csv_file.write(row + "\n");
  });
  json_file.commit();
  csv_file.commit();
  std::erase_if(merged.numbers, [](const Spread& s) { return s.count == 0 || s.name == "id" || s.name == "seed"; });
  return merged;
}

}  // namespace host_sim::sweep
