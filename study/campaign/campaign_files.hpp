// Results of a campaign for reading, for scripts, for maps.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/render/table.hpp"
#include "lib/cli/text.hpp"
#include "study/campaign/campaign.hpp"

namespace twinchute::study {

compare::Table answers_table(const Campaign& campaign);
compare::Table indices_table(const Campaign& campaign, const MetricIndices& indices);
compare::Table inputs_table(const Campaign& campaign);
compare::Table failures_table(const Campaign& campaign);
compare::Table pairs_table(const MultiFidelity& both);
/// Sentences that belong below the answers: how rare events were simulated, and how runs of both models would
/// be shared out best.
std::vector<std::string> answer_notes(const Campaign& campaign);

std::string campaign_text(const Campaign& campaign, const Style& style);
/// docs/schema/campaign.schema.json.
std::string campaign_json(const Campaign& campaign);
/// A self-contained page without scripts.
std::string campaign_page(const Campaign& campaign);
/// A test case for each answer with a limit.
std::string campaign_junit(const Campaign& campaign);
/// Landing points and ellipses around the release; only with CampaignSpec::release_point.
std::string campaign_kml(const Campaign& campaign);

/// The first `count` runs as CSV, names in the first line, units in the second, through a temporary file.
/// Throws WriteError.
void export_csv(const CampaignRuns& runs, std::uint64_t count, const std::filesystem::path& target);

/// A probability in per cent, any other number with its unit: "0.12 %", "5.3 kN" is "5300 N".
std::string answer_number(const AnswerSpec& answer, double value);

}  // namespace twinchute::study
