#include "host_sim/commands/diagnose_campaign.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/version.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/campaign/campaign_list.hpp"
#include "host_sim/campaign/campaign_result.hpp"
#include "host_sim/commands/common/emphasis.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/sweep/shard.hpp"

namespace host_sim {
namespace {

namespace fs = std::filesystem;
using campaign::CampaignRecord;
using nlohmann::ordered_json;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A record of the campaign, the files that its verdict is made of, and where it stands.
struct Job {
  CampaignRecord record;
  report::Origin origin{};
  fs::path folder{};
  firmware::CalendarDate recorded{};
};

/// The files are read here and nowhere else, on all processors.
std::vector<Job> jobs_of(const DiagnoseOptions& options, const std::vector<CampaignRecord>& records) {
  std::vector<Job> jobs(records.size());
  const firmware::CalendarDate recorded = day_recorded(options);
  identification::for_all(records.size(), [&](std::size_t i) {
    const std::string rig = records[i].rig.string(), data = records[i].data.string();
    jobs[i] = {records[i], origin_of("rigtwin diagnose --rig " + rig + " --data " + data, {rig, data}),
               options.out / "records" / records[i].name, recorded};
  });
  return jobs;
}

/// Of a record that is done, beside its verdict.json: {"made_of": "…", "seconds": …, "failure": "…"}. Written last.
struct Done {
  ordered_json state, verdict;
};

/// Version and contents: what is made of the same is not made again.
std::string fingerprint(const report::Origin& origin) {
  std::string text(firmware::version);
  for (const report::Origin::Input& input : origin.inputs) text += " " + input.sha256;
  return text;
}

std::optional<Done> known(const Job& job) {
  Done done{ordered_json::parse(text_of(job.folder / "state.json"), nullptr, false),
            ordered_json::parse(text_of(job.folder / "verdict.json"), nullptr, false)};
  if (!done.state.is_object() || done.state.value("made_of", ordered_json()) != fingerprint(job.origin))
    return std::nullopt;
  if (!done.verdict.is_object()) {
    if (!done.state.contains("failure")) return std::nullopt;
    done.verdict = ordered_json::object();
  }
  return done;
}

/// Diagnoses one record. What is wrong with it is its state, and no error of the campaign.
void diagnose_record(const Job& job) {
  const auto& [record, origin, folder, recorded] = job;
  const auto begun = std::chrono::steady_clock::now();
  ordered_json state{{"made_of", fingerprint(origin)}};
  std::error_code none;
  fs::create_directories(folder, none);
  try {
    const firmware::RigDescription description = firmware::read_rig(record.rig);
    firmware::refuse_compensation(description, "diagnose");
    std::vector<identification::Record> records;
    for (firmware::Recording& part :
         read_parts(record.data, description.channels, description.sample_rate, description.rig.kind)) {
      records.push_back({std::move(part), identification::Use::shared});
    }
    identification::Diagnosis diagnosis = identification::diagnose(description, std::move(records));
    diagnosis.certificates = firmware::certificate_objections(description.calibration, recorded);
    firmware::write_file(folder / "verdict.json",
                         json_text(origin, "rigtwin/diagnose/1", identification::to_json(diagnosis)));
    firmware::write_file(folder / "rig.toml",
                         identification::result_rig(diagnosis.rig, description, record.rig.filename().string()));
  } catch (const firmware::OutputError&) {
    throw;
  } catch (const firmware::InputError& error) {
    state["failure"] = error.what();
  } catch (const std::exception& error) {
    state["failure"] = std::string("internal error: ") + error.what();
  }
  if (state.contains("failure")) {  // of an earlier recording
    for (const char* const file : {"verdict.json", "rig.toml"}) fs::remove(folder / file, none);
  }
  state["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  firmware::write_file(folder / "state.json",
                       state.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void prepare_results(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder / "records", error);
  if (error) {
    throw firmware::OutputError(folder.string(), "cannot be created: " + error.message(),
                                "a folder that may be written");
  }
}

/// Every record of this shard, on all processors.
void diagnose_shard(const std::vector<Job>& jobs, const sweep::Shard& shard) {
  std::vector<std::size_t> mine;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (shard.holds(i)) mine.push_back(i);
  }
  Progress progress("diagnose --campaign");
  std::mutex showing;
  std::size_t done = 0;
  identification::for_all(mine.size(), [&](std::size_t i) {
    const Job& job = jobs[mine[i]];
    if (!known(job)) diagnose_record(job);
    const std::lock_guard lock(showing);
    ++done;
    progress.show(static_cast<double>(done) / static_cast<double>(mine.size()),
                  std::to_string(done) + " of " + std::to_string(mine.size()) + ": " + job.record.name);
  });
}

std::optional<campaign::Campaign> earlier_campaign(const fs::path& folder) {
  if (folder.empty()) return std::nullopt;
  const fs::path file = folder / "campaign.json";
  return campaign::read_campaign(text_of(file), file.string());
}

void write_results(const DiagnoseOptions& options, const campaign::Campaign& result,
                   const std::optional<campaign::Campaign>& earlier) {
  const HowMade how_made;
  ordered_json json = campaign::to_json(result);
  json["schema"] = "rigtwin/campaign/1";
  firmware::OutputFile table(options.out / "campaign.csv"), page(options.out / "report.html"),
      all(options.out / "campaign.json");
  table.write(campaign::to_csv(result));
  page.write(how_made.in(campaign::campaign_page(result, earlier)));
  all.write(how_made.json(json));
  table.commit();
  page.commit();
  all.commit();
  if (write_json(options.json, json)) return;
  std::printf("%s\n", emphasised(campaign::sentence(result), Emphasis::bold, stdout).c_str());
  for (std::size_t i = 0; i < result.outliers.size(); ++i) {
    std::printf("  %s: %s\n", result.rows[result.outliers[i]].name.c_str(), result.why[i].c_str());
  }
  for (const auto& [name, q] : result.quantities) {
    std::printf("  %-40s %12.5g ± %.2g, from record to record %.2g%s\n", name.c_str(), q.mean, q.mean_deviation,
                q.spread, q.drifts() ? ", drifts" : "");
  }
  std::printf("%s: campaign.csv, campaign.json, report.html\n", options.out.c_str());
}

}  // namespace

void run_campaign(const DiagnoseOptions& options) {
  if (options.out.empty()) throw firmware::UsageError("diagnose --campaign: --out is needed");
  if (!options.data.empty() || !options.holdout.empty() || !options.keep_law.empty()) {
    throw firmware::UsageError("diagnose --campaign: --data, --holdout and --keep-law are for a single diagnosis");
  }
  std::error_code none;
  if (fs::equivalent(options.campaign, options.out, none)) {
    throw firmware::UsageError("diagnose --campaign: --out is the folder of the recordings, expected another one");
  }
  const std::optional<campaign::Campaign> earlier = earlier_campaign(options.against);
  const sweep::Shard shard = options.shard.empty()
                                 ? sweep::shard_of_engine(sweep::process_environment).value_or(sweep::Shard{})
                                 : sweep::parse_shard(options.shard);
  const std::vector<Job> jobs = jobs_of(
      options, campaign::campaign_records(options.campaign,
                                          options.rig.empty() ? std::nullopt : std::optional<fs::path>(options.rig)));
  prepare_results(options.out);
  diagnose_shard(jobs, shard);
  std::vector<campaign::Row> rows;
  std::size_t missing = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto done = known(jobs[i]);
    if (done) rows.push_back(campaign::row_of(done->verdict, done->state, i, jobs[i].record.name));
    missing += done ? 0 : 1;
  }
  if (missing > 0) {
    std::printf("%zu of %zu records are there; the shard that completes them writes the campaign\n",
                jobs.size() - missing, jobs.size());
    return;
  }
  write_results(options, campaign::campaign_of(std::move(rows)), earlier);
}

}  // namespace host_sim
