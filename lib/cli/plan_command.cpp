#include "lib/cli/plan_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "lib/cli/record_text.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/scene_id.hpp"

namespace twinchute {
namespace {

using nlohmann::ordered_json;

struct Planned {
    const Fidelity* fidelity;
    std::vector<std::string> unsupported_keys;  ///< empty: there is a plan
    std::string why_not;                        ///< in words
    Plan plan;
};

std::string bytes_text(std::size_t bytes) {
    constexpr double kilo = 1e3, mega = 1e6;
    const auto b = static_cast<double>(bytes);
    if (b < kilo) return fmt::format("{} B", bytes);
    return b < mega ? readable(b / kilo, 3) + " kB" : readable(b / mega, 3) + " MB";
}

/// Lists the parts that are needed, or those left out.
std::string parts_text(const Plan& plan, bool needed) {
    Table table;
    for (const PlanPart& part : plan.parts) {
        if (part.needed != needed) continue;
        std::vector<std::string> row{std::string(kind_name(part.kind)), part.name};
        if (needed) row.push_back(part.what);
        row.push_back(part.why);
        table.rows.push_back(std::move(row));
    }
    return aligned(table, {}, 2);
}

std::string arrays_text(const Plan& plan) {
    Table table;
    table.right = {false, true};
    for (const PlanArray& array : plan.arrays)
        table.rows.push_back({array.name, bytes_text(array.bytes)});
    table.rows.push_back({"all", bytes_text(plan.bytes())});
    return aligned(table, {}, 2);
}

std::string stages_text(const Plan& plan) {
    Table table;
    table.header = {"stage", "from", "to", "step", "steps", "a step takes", "all take"};
    table.right = {false, true, true, true, true, true, true};
    const auto row = [&](const std::string& name, const std::string& from, const std::string& to, double step,
                         double steps, double seconds) {
        table.rows.push_back({name, from, to, time_text(step), fmt::format("{:.0f}", steps),
                              time_text(steps > 0.0 ? seconds / steps : 0.0), time_text(seconds)});
    };
    const auto at = [](double time) { return fmt::format("{:.3f} s", time); };
    for (const PlanStage& stage : plan.stages) {
        if (plan.whole)
            row(stage.name, at(stage.begin), at(stage.end), stage.step(), stage.steps, stage.seconds);
        else
            row(stage.name, "", "", stage.step(), 1.0, stage.seconds);
    }
    if (plan.whole && plan.stages.size() > 1) {
        const double first = plan.stages.front().begin, last = plan.stages.back().end, steps = plan.steps();
        row("all", at(first), at(last), steps > 0.0 ? (last - first) / steps : 0.0, steps, plan.seconds());
    }
    return aligned(table, {}, 2);
}

std::string plan_text(const Planned& planned, const Style& style) {
    std::string text = "\n" + style.paint(planned.fidelity->title, Colour::bold) + "\n";
    if (!planned.unsupported_keys.empty())
        return text + fmt::format("  cannot run this scene: {}\n", planned.why_not);
    const Plan& plan = planned.plan;
    return text + "\nneeded\n" + parts_text(plan, true) + "\nleft out\n" + parts_text(plan, false) +
           "\nmemory\n" + arrays_text(plan) + "\ncost\n" + stages_text(plan) + "  " + printable(plan.how) +
           "\n";
}

ordered_json part_json(const PlanPart& part) {
    ordered_json json{{"kind", kind_name(part.kind)}, {"name", part.name}};
    if (!part.what.empty()) json["what"] = part.what;
    json["why"] = part.why;
    return json;
}

ordered_json plan_json(const Planned& planned) {
    ordered_json json{{"fidelity", planned.fidelity->name}};
    if (!planned.unsupported_keys.empty()) {
        json["unsupported_keys"] = planned.unsupported_keys;
        return json;
    }
    const Plan& plan = planned.plan;
    ordered_json needed = ordered_json::array(), left_out = needed, arrays = ordered_json::object(),
                 stages = needed;
    for (const PlanPart& part : plan.parts)
        (part.needed ? needed : left_out).push_back(part_json(part));
    for (const PlanArray& array : plan.arrays)
        arrays[array.name] = array.bytes;
    for (const PlanStage& stage : plan.stages) {
        ordered_json row{{"name", stage.name}};
        if (plan.whole) {
            row["begin_s"] = stage.begin;
            row["end_s"] = stage.end;
            row["steps"] = std::llround(stage.steps);
            row["wall_s"] = stage.seconds;
        }
        row["step_s"] = stage.step();
        row["wall_per_step_s"] = stage.seconds_per_step();
        stages.push_back(std::move(row));
    }
    json["needed"] = std::move(needed);
    json["left_out"] = std::move(left_out);
    json["bytes"] = std::move(arrays);
    json["stages"] = std::move(stages);
    if (plan.whole) {
        json["steps"] = std::llround(plan.steps());
        json["wall_s"] = plan.seconds();
    }
    json["how"] = plan.how;
    return json;
}

std::vector<Planned> plans_of(const Scene& scene, const std::vector<const Fidelity*>& fidelities,
                              int threads) {
    std::vector<Planned> plans;
    std::optional<RunRecord> expected;
    for (const Fidelity* fidelity : fidelities) {
        Planned planned{fidelity, fidelity->unsupported_keys(scene), {}, {}};
        planned.why_not = unsupported_text(scene, planned.unsupported_keys);
        if (planned.unsupported_keys.empty()) {
            PlanBasis basis;
            basis.expected = expected ? &*expected : nullptr;
            basis.threads = fidelity->has_threads ? threads : 1;
            planned.plan = fidelity->plan(scene, basis);
            if (fidelity == fidelities.front() && fidelities.size() > 1) {
                Run run;
                expected = fidelity->run(scene, run);
            }
        }
        plans.push_back(std::move(planned));
    }
    return plans;
}

ExitCode run_plan(const std::vector<const Fidelity*>& fidelities, const Arguments& arguments) {
    const std::vector<Scene> scenes = scenes_of(arguments);
    const int threads = threads_of(arguments);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    std::vector<std::string> texts;
    for (const Scene& scene : scenes) {
        const std::vector<Planned> plans = plans_of(scene, fidelities, threads);
        if (arguments.has("json")) {
            ordered_json all = ordered_json::array();
            for (const Planned& planned : plans)
                all.push_back(plan_json(planned));
            texts.push_back(json_text({{"generator", "twinchute"},
                                       {"scene", scene_json(scene_id(scene))},
                                       {"plans", std::move(all)}}));
            continue;
        }
        if (arguments.has("quiet")) continue;
        const Style style = output_style();
        std::string text = style.paint(printable(scene.name), Colour::bold);
        if (!scene.case_name.empty()) text += ", " + printable(scene.case_name);
        text += "\n";
        for (const Planned& planned : plans)
            text += plan_text(planned, style);
        print((&scene == &scenes.front() ? "" : "\n") + text);
    }
    if (arguments.has("json")) print(joined_json(scenes, texts));
    return ExitCode::done;
}

}  // namespace

Command plan_command(std::vector<const Fidelity*> fidelities) {
    Command command;
    command.name = "plan";
    command.summary = "what a scene needs and leaves out, and what its runs will cost";
    command.operand = "SCENE";
    command.example = "twinchute plan data/scenes/c9-inflation.toml";
    command.options = scene_options("");
    command.options.front() = threads_option();  // nothing is written, so that there is no --out
    std::erase_if(fidelities, [](const Fidelity* fidelity) { return fidelity->plan == nullptr; });
    command.run = [fidelities = std::move(fidelities)](const Arguments& arguments) {
        return run_plan(fidelities, arguments);
    };
    return command;
}

}  // namespace twinchute
