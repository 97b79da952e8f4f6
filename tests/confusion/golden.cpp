#include "tests/confusion/golden.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace confusion {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Run& run) {
  ordered_json json{{"seed", run.seed}, {"duration", run.wanted.duration}, {"weak", run.wanted.weak}};
  if (run.wanted.varied) json["varied"] = true;
  return json;
}

}  // namespace

ordered_json golden_copy(const Run& run, const std::string& date, const Table& table,
                         const std::vector<Outcome>& outcomes) {
  ordered_json json{{"date", date}, {"run", to_json(run)}, {"table", confusion::to_json(table)}};
  json["recordings"] = ordered_json::object();
  for (const Outcome& o : outcomes) {
    ordered_json& entry = json["recordings"][o.asked.id()];
    entry = {{"right", o.right()}, {"wrong_name", o.wrong_name()}, {"found", o.found}, {"hidden", o.hidden}};
    if (o.unexplained) entry["rest"] = o.rest;
  }
  return json;
}

std::vector<std::string> regressions(const Run& run, const std::vector<Outcome>& outcomes, const ordered_json& golden) {
  if (golden.at("run") != to_json(run)) {
    return {"the golden copy is of another run: " + golden.at("run").dump() + ", this is " + to_json(run).dump()};
  }
  struct Count {
    std::size_t now = 0, then = 0, both = 0;
  };
  std::map<std::string, Count> right;
  Count wrong_names;
  for (const Outcome& o : outcomes) {
    const auto entry = golden.at("recordings").find(o.asked.id());
    if (entry == golden.at("recordings").end()) continue;
    Count& count = right[o.asked.what()];
    count.now += o.right() ? 1 : 0;
    count.then += entry->at("right").get<bool>() ? 1 : 0;
    ++count.both;
    wrong_names.now += o.wrong_name() ? 1 : 0;
    wrong_names.then += entry->at("wrong_name").get<bool>() ? 1 : 0;
  }
  std::vector<std::string> worse;
  if (right.empty()) worse.emplace_back("the golden copy holds none of these recordings");
  const std::string date = golden.at("date");
  for (const auto& [what, count] : right) {
    if (count.now >= count.then) continue;
    worse.push_back(what + ": " + std::to_string(count.now) + " of " + std::to_string(count.both) + " right, " +
                    std::to_string(count.then) + " on " + date);
  }
  if (wrong_names.now > wrong_names.then) {
    worse.push_back("wrong names above 0.5: " + std::to_string(wrong_names.now) + ", " +
                    std::to_string(wrong_names.then) + " on " + date);
  }
  return worse;
}

std::vector<std::string> shortfalls(const Table& table) {
  std::vector<std::string> worse;
  for (const auto& [what, share] : table.right) {
    const double least = share.of >= 10 ? 0.9 : 0.8;
    if (share.value() >= least) continue;
    worse.push_back(what + ": " + std::to_string(share.count) + " of " + std::to_string(share.of) + " right");
  }
  return worse;
}

}  // namespace confusion
