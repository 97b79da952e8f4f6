// rigtwin_reference: a plain second diagnosis beside the product's, over recordings whose answer is known.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "firmware/recording/output_file.hpp"
#include "tests/reference/agreement.hpp"

namespace {

struct Options {
  std::uint64_t seed = 1;
  std::vector<std::string> groups;
  unsigned part = 1, parts = 1;
  truth::Wanted wanted;
  double least = 0.0;
  std::string out;
};

int main_of(const Options& options) {
  std::vector<confusion::Asked> asked = confusion::part_of(confusion::plan(options.seed), options.part, options.parts);
  std::erase_if(asked, [&](const confusion::Asked& a) {
    const std::string what = a.what();
    const auto holds = [&](const std::string& text) { return a.id().find(text) != std::string::npos; };
    const bool chosen = options.groups.empty() || std::any_of(options.groups.begin(), options.groups.end(), holds);
    return !chosen || (what != "single" && what != "pair" && what != "none");
  });
  std::vector<reference::Compared> all;
  for (const confusion::Asked& a : asked) {
    all.push_back(reference::compare(a, options.wanted));
    std::fprintf(stderr, "%3zu/%zu %s %s\n", all.size(), asked.size(), all.back().agree() ? "same" : "DIFFERENT",
                 a.id().c_str());
  }
  const std::string words = reference::text(all);
  std::printf("%s", words.c_str());
  if (!options.out.empty()) firmware::write_file(options.out, words);
  return reference::agreement(all) < options.least ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"A plain second diagnosis beside the product's, over recordings whose answer is known"};
  app.add_option("--seed", options.seed, "First seed of every group")->capture_default_str();
  app.add_option("--groups", options.groups, "Only recordings whose id holds one of these texts");
  app.add_option("--part", options.part, "Only this part of --parts")->check(CLI::PositiveNumber);
  app.add_option("--parts", options.parts, "How many parts there are")->check(CLI::PositiveNumber);
  app.add_option("--duration", options.wanted.duration, "Length of a recording [s]")->capture_default_str();
  app.add_option("--least", options.least, "Status 1 where a smaller share of the recordings is answered alike");
  app.add_option("--out", options.out, "File for the table");
  try {
    app.parse(argc, argv);
    return main_of(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "rigtwin_reference: %s\n", problem.what());
    return 5;
  }
}
