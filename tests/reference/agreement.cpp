#include "tests/reference/agreement.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>

#include "firmware/recording/recording_csv.hpp"
#include "tests/confusion/workers.hpp"
#include "tests/reference/diagnose.hpp"

namespace reference {
namespace {

std::string listed(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " and ") + name;
  return text.empty() ? "nothing" : text;
}

/// A line of the table.
struct Counts {
  std::size_t all = 0, agree = 0, both = 0, product = 0, reference = 0, neither = 0;

  void add(const Compared& c) {
    ++all;
    agree += c.agree() ? 1U : 0U;
    const bool a = c.product == c.hidden, b = c.reference == c.hidden;
    ++(a && b ? both : a ? product : b ? reference : neither);
  }
};

std::string line(const std::string& what, const Counts& n) {
  std::array<char, 160> text{};
  const double share = 100.0 * static_cast<double>(n.agree) / static_cast<double>(std::max<std::size_t>(n.all, 1));
  (void)std::snprintf(text.data(), text.size(), "%-26s %4zu of %4zu %6.1f %%   %5zu %9zu %11zu %9zu\n", what.c_str(),
                      n.agree, n.all, share, n.both, n.product, n.reference, n.neither);
  return text.data();
}

}  // namespace

Compared compare(const confusion::Asked& asked, const truth::Wanted& wanted) {
  constexpr unsigned most_seconds = 600;
  const confusion::Outcome product = confusion::run_all({asked}, wanted, 1, most_seconds, {}).front();
  Compared result{asked, product.hidden, {}, {}, {}};
  for (const confusion::Named& named : product.named) {
    if (named.confidence > 0.5) result.product.insert(named.effect);
  }
  result.product_unexplained = product.flagged();
  result.product_seconds = product.wall;

  const truth::Truth truth = truth::draw(asked.group, asked.seed, wanted);
  for (const truth::Effect& effect : truth.effects) {
    result.hidden.insert(effect.name + (effect.channel.empty() ? "" : " of " + effect.channel));
  }
  const Description description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  std::vector<firmware::Recording> recordings;
  for (const truth::Record& record : truth::simulate(truth)) {
    recordings.push_back(firmware::parse_recording_csv(truth::csv(truth, record), "rec.csv", description.channels,
                                                       description.sample_rate));
  }
  const auto begin = std::chrono::steady_clock::now();
  const Verdict verdict = diagnose(description, recordings);
  result.reference_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const auto& [cause, confidence] : verdict.causes) {
    if (confidence > 0.5) result.reference.insert(words(cause));
  }
  result.reference_unexplained = verdict.unexplained > 0.5;
  return result;
}

double agreement(const std::vector<Compared>& all) {
  const auto same = std::count_if(all.begin(), all.end(), [](const Compared& c) { return c.agree(); });
  return all.empty() ? 1.0 : static_cast<double>(same) / static_cast<double>(all.size());
}

std::string text(const std::vector<Compared>& all) {
  std::map<std::string, Counts> kinds;
  Counts sum;
  double product = 0.0, own = 0.0;
  std::string differences;
  for (const Compared& c : all) {
    const std::size_t second = c.asked.group.find(':', c.asked.group.find(':') + 1);
    kinds[c.asked.group.substr(0, second)].add(c);
    sum.add(c);
    product += c.product_seconds;
    own += c.reference_seconds;
    if (c.agree()) continue;
    const char* const right = c.product == c.hidden ? "product" : c.reference == c.hidden ? "reference" : "neither";
    differences += "  " + c.asked.id() + ": " + right + " right; hidden " + c.hidden_words + "; product " +
                   listed(c.product) + (c.product_unexplained ? ", unexplained" : "") + "; reference " +
                   listed(c.reference) + (c.reference_unexplained ? ", unexplained" : "") + "\n";
  }
  std::string result = "                              the same names   right: both   product   reference   neither\n";
  for (const auto& [kind, counts] : kinds) result += line(kind, counts);
  result += line("all", sum);
  std::array<char, 80> time{};
  (void)std::snprintf(time.data(), time.size(), "time: product %.0f s, reference %.0f s\n", product, own);
  return result + time.data() + (differences.empty() ? "" : "\nnot the same\n" + differences);
}

}  // namespace reference
