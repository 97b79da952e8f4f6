// Rows from verdicts; a campaign as JSON, as a table, as a page.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "host_sim/campaign/fleet.hpp"

namespace host_sim::campaign {

/// The row of a verdict.json, {} where there is none, and of its state {"failure": "…", "seconds": …}; `record`: its
/// number in the campaign.
[[nodiscard]] Row row_of(const nlohmann::ordered_json& verdict, const nlohmann::ordered_json& state, std::size_t record,
                         std::string name);

/// campaign.json (host_sim/schemas/campaign.json).
[[nodiscard]] nlohmann::ordered_json to_json(const Campaign& campaign);

/// One row a record: record, verdict, effects, gap, and a column for each quantity with its lower and upper end.
[[nodiscard]] std::string to_csv(const Campaign& campaign);

/// The campaign in a sentence: the commonest verdicts with their number, outliers, drifts. Page and command begin with it.
[[nodiscard]] std::string sentence(const Campaign& campaign);

/// The sentence, outliers first, each quantity over the records with its band, the table. `earlier`: a campaign before a
/// change; its quantities stand beside.
[[nodiscard]] std::string campaign_page(const Campaign& campaign, const std::optional<Campaign>& earlier);

/// A campaign read back from campaign.json. InputError where the file is none.
[[nodiscard]] Campaign read_campaign(const std::string& text, const std::string& source);

}  // namespace host_sim::campaign
