#include "study/campaign/read_answers.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::study {
namespace {

using compare::SuiteTable;

/// Finds the metric by its name without unit, and its unit.
const MetricRow& metric_of(const SuiteTable& reader, std::string_view key, const std::string& name) {
    if (const MetricRow* row = find_metric_row(name)) return *row;
    std::vector<std::string_view> names;
    for (const MetricRow& row : metric_rows())
        names.push_back(row.name);
    reader.refuse(key, fmt::format("'{}' is no metric", name), "", suggest(name, names));
}

void take_metric(const SuiteTable& reader, std::string_view key, const std::string& name,
                 AnswerSpec& answer) {
    const MetricRow& row = metric_of(reader, key, name);
    answer.metric = row.key;
    answer.unit = row.unit;
}

/// "peak_force > 12 kN".
void read_condition(const SuiteTable& reader, AnswerSpec& answer) {
    const std::size_t sign = answer.asked.find_first_of("<>");
    if (sign == std::string::npos)
        reader.refuse("probability", "has no < or >", "a metric is compared with a number",
                      "write e.g. \"peak_force > 12 kN\"");
    answer.above = answer.asked[sign] == '>';
    const std::string_view asked = answer.asked;
    const std::string name(trimmed(asked.substr(0, sign)));
    const MetricRow& row = metric_of(reader, "probability", name);
    answer.metric = row.key;
    answer.unit = row.unit;
    try {
        answer.threshold = to_si(trimmed(asked.substr(sign + 1)), row.tolerance_unit());
    } catch (const UnitError& error) {
        reader.refuse("probability", error.problem(), error.why(), error.suggestion());
    }
}

double level_of(SuiteTable& reader, double fallback) {
    const double level = reader.amount("level", "1").value_or(fallback);
    if (!(level > 0.0 && level < 1.0))
        reader.refuse("level", "is not between 0 and 1", "", "write e.g. level = \"99 %\"");
    return level;
}

AnswerSpec read_answer(SuiteTable& reader) {
    AnswerSpec answer;
    answer.place = reader.place();
    answer.name = reader.needed_text("name", "results are told by it");
    using enum AnswerSpec::Kind;
    constexpr const char* kinds[] = {"probability", "quantile", "mean", "ellipse"};
    int given = 0;
    for (const AnswerSpec::Kind kind : {probability, quantile, mean, ellipse}) {
        const char* key = kinds[static_cast<std::size_t>(kind)];
        const std::string text = reader.text(key);
        if (text.empty()) continue;
        answer.kind = kind;
        answer.asked = text;
        ++given;
        if (kind == quantile || kind == mean) take_metric(reader, key, text, answer);
        if (kind == ellipse && text != "landing")
            reader.refuse(key, fmt::format("'{}' has no place on the ground", text), "",
                          "write ellipse = \"landing\"");
    }
    if (given != 1)
        reader.refuse("name", fmt::format("'{}' asks {} questions", answer.name, given), "",
                      "give exactly one of probability, quantile, mean and ellipse");
    if (answer.kind == probability) read_condition(reader, answer);
    if (answer.kind == quantile) reader.need("level", "which quantile it is");
    if (answer.kind == quantile || answer.kind == ellipse) answer.level = level_of(reader, 0.95);
    if (answer.kind == ellipse) answer.unit = "m";
    const std::string unit = answer.kind == probability || answer.unit.empty() ? "1" : answer.unit;
    answer.limit = reader.amount("limit", unit == "g" ? "g0" : unit);
    reader.end();
    return answer;
}

}  // namespace

void read_answers(SuiteTable& top, CampaignSpec& spec) {
    for (SuiteTable& reader : top.list("answer")) {
        AnswerSpec answer = read_answer(reader);
        if (std::ranges::count(spec.answers, answer.name, &AnswerSpec::name) > 0)
            reader.refuse("name", fmt::format("two answers are called '{}'", answer.name), "",
                          "name each once");
        spec.answers.push_back(std::move(answer));
    }
}

}  // namespace twinchute::study
