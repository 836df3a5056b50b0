#include <fmt/format.h>

#include <unistd.h>
#include <cmath>
#include <fstream>
#include <system_error>

#include "compare/render/escape.hpp"
#include "lib/math/geodesy.hpp"
#include "lib/record/file_batch.hpp"
#include "study/campaign/campaign_files.hpp"

namespace twinchute::study {
namespace {

/// A number for CSV that reads back the same; nothing of what is missing.
void append_number(std::string& text, double value) {
    if (!std::isnan(value)) fmt::format_to(std::back_inserter(text), "{}", value);
}

}  // namespace

std::string campaign_text(const Campaign& campaign, const Style& style) {
    const CampaignResults& r = campaign.results;
    std::string text = style.paint(printable(campaign.spec.name), Colour::bold) +
                       fmt::format("\n{} of {} runs of {}, {} inputs, design {}, seed {}\n", r.made, r.wanted,
                                   printable(campaign.sampler->nominal().name), campaign.spec.inputs.size(),
                                   design_name(campaign.spec.design), campaign.spec.seed);
    text += fmt::format("{}; {} threads, {:.3g} s\n\n", campaign.of.front().engine, campaign.threads,
                        campaign.seconds);
    text += terminal_table(answers_table(campaign), style);
    for (const MetricIndices& indices : r.indices)
        text += fmt::format("\nshare of the variance of {}\n", metric_words(indices.metric)) +
                terminal_table(indices_table(campaign, indices), style);
    if (campaign.both) text += "\n" + terminal_table(pairs_table(*campaign.both), style);
    for (const std::string& note : answer_notes(campaign))
        text += "\n" + printable(note) + "\n";
    if (const auto failures = failures_table(campaign); !failures.rows.empty())
        text += "\n" + terminal_table(failures, style);
    return text + "\n";
}

std::string campaign_junit(const Campaign& campaign) {
    std::string cases;
    int failed = 0, count = 0;
    const auto add = [&](const AnswerSpec& spec, const Interval& value, Verdict verdict, const char* of) {
        if (verdict == Verdict::open) return;
        ++count;
        cases += fmt::format("  <testcase classname=\"twinchute.campaign{}\" name=\"{}\"", of,
                             compare::xml_text(spec.name));
        if (verdict == Verdict::met) {
            cases += "/>\n";
            return;
        }
        ++failed;
        cases += fmt::format(
            ">\n    <failure type=\"{}\" message=\"{}\"/>\n  </testcase>\n", verdict_name(verdict),
            compare::xml_text(fmt::format("{}: {} (95 % interval {} to {}), limit {}", spec.name,
                                          answer_number(spec, value.estimate), answer_number(spec, value.low),
                                          answer_number(spec, value.high),
                                          answer_number(spec, *spec.limit))));
    };
    for (const Judgement& j : judgements(campaign))
        add(*j.spec, j.value, j.verdict, j.is_of_full ? ".full" : "");
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" "
        "failures=\"{}\" errors=\"0\">\n{}</testsuite>\n",
        compare::xml_text(campaign.spec.name), count, failed, cases);
}

void export_csv(const CampaignRuns& runs, std::uint64_t count, const std::filesystem::path& target) {
    const StoreIdentity& identity = runs.store->identity();
    std::filesystem::path temporary = target;
    temporary.replace_filename(fmt::format(".{}.{}-0.tmp", target.filename().string(), ::getpid()));
    FileBatch batch;
    batch.adopt(target, temporary);
    std::ofstream stream(temporary, std::ios::binary);
    std::string text = "run", units;
    for (std::size_t i = 0; i < identity.columns.size(); ++i) {
        text += "," + identity.columns[i];
        units += "," + identity.units[i];
    }
    stream << text << '\n' << units << '\n';
    for (std::uint64_t chunk = 0; chunk < runs.store->chunks_of(count); ++chunk) {
        const auto rows = runs.store->read(chunk, runs.store->rows_of(chunk, count));
        text.clear();
        for (std::size_t at = 0; at < rows.size(); at += runs.store->columns()) {
            fmt::format_to(std::back_inserter(text), "{},{}",
                           chunk * identity.chunk + at / runs.store->columns(),
                           identity.statuses[static_cast<std::size_t>(rows[at])]);
            for (std::size_t i = 1; i < runs.store->columns(); ++i) {
                text += ',';
                append_number(text, rows[at + i]);
            }
            text += '\n';
        }
        stream << text;
    }
    stream.close();
    if (!stream) throw WriteError(target, errno);
    batch.commit();
}

std::string campaign_kml(const Campaign& campaign) {
    const LocalMap map((*campaign.spec.release_point)[0], (*campaign.spec.release_point)[1]);
    const auto place = [&](double east, double north) {
        const GeographicPlace at = map.at(east, north);
        return fmt::format("{:.8f},{:.8f},0", at.longitude, at.latitude);
    };
    const Columns& columns = campaign.of.front().columns;
    const std::size_t east = *columns.of("landing_east_m"), north = *columns.of("landing_north_m");
    std::string body;
    for (const Answer& answer : campaign.results.answers) {
        if (!answer.ellipse) continue;
        const Ellipse& e = *answer.ellipse;
        body += fmt::format("<Placemark><name>{}</name><LineString><tessellate>1</tessellate><coordinates>\n",
                            compare::xml_text(answer.spec->name));
        constexpr int corners = 72;
        for (int k = 0; k <= corners; ++k) {
            const double t = 2.0 * 3.14159265358979323846 * k / corners;
            const double x = e.major.estimate * std::cos(t), y = e.minor.estimate * std::sin(t);
            const double c = std::cos(e.angle), s = std::sin(e.angle);
            body += place(e.centre.x() + c * x - s * y, e.centre.y() + s * x + c * y) + "\n";
        }
        body += "</coordinates></LineString></Placemark>\n";
    }
    body += "<Placemark><name>landing points</name><MultiGeometry>\n";
    for (const std::vector<double>& row : campaign.results.examples)
        if (!std::isnan(row[east]))
            body += "<Point><coordinates>" + place(row[east], row[north]) + "</coordinates></Point>\n";
    body += "</MultiGeometry></Placemark>\n";
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">"
        "<Document><name>{}</name>\n{}</Document></kml>\n",
        compare::xml_text(campaign.spec.name), body);
}

}  // namespace twinchute::study
