// rigtwin diagnose --campaign: many recordings of one rig or of a fleet.
#pragma once

#include "host_sim/commands/diagnose_command.hpp"

namespace host_sim {

/// Each recording is diagnosed alone, on all processors; DIR/records/NAME holds its verdict.json and rig.toml. A record
/// whose verdict is there, made of the same bytes by the same version, is not diagnosed again. Where all verdicts are
/// there: DIR/campaign.json, campaign.csv, report.html. What is wrong with a record is its row, not the campaign's end.
void run_campaign(const DiagnoseOptions& options);

}  // namespace host_sim
