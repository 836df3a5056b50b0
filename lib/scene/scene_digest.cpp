#include "lib/scene/scene_digest.hpp"

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>

#include "lib/math/sha256.hpp"
#include "lib/scene/write_scene.hpp"

namespace twinchute {
namespace {

/// Numbers to the last bit under a name: what write_scene knows by the name of a file alone.
class Contents {
public:
    void add(std::string_view name, const std::vector<double>& numbers) {
        text_ += fmt::format("{} = [{}]\n", name, fmt::join(numbers, ", "));
    }
    void add(const Fabric& f) {
        add(f.name, {f.density, f.youngs_modulus, f.poisson_ratio, f.thickness, f.strength.value_or(-1.0)});
        if (f.permeability) add("permeability", {f.permeability->alpha, f.permeability->beta});
    }
    void add(const Cord& c) {
        add(c.name, {c.density, c.youngs_modulus, c.diameter, c.strength.value_or(-1.0)});
    }
    void add(const FillTime& fill) {
        if (!fill.table) return;
        add(fill.table->by == FillTable::By::mass_ratio ? "mass ratio" : "Froude number", fill.table->at);
        add("fill constant", fill.table->n);
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

}  // namespace

std::string scene_digest(const Scene& scene) {
    Scene same = scene;
    same.full.checkpoint_interval = 0.0;
    same.tolerances.clear();
    same.size.reset();
    same.uncertainty.reset();
    same.series.reset();
    Contents contents;
    const AirTable& air = scene.environment.atmosphere.table;
    contents.add("altitude", air.altitude);
    contents.add("temperature", air.temperature);
    contents.add(air.beside == AirTable::Beside::pressure ? "ln pressure" : "ln density", air.logarithm);
    if (scene.environment.wind)
        for (const WindLevel& level : scene.environment.wind->levels)
            contents.add("wind",
                         {level.altitude, level.velocity.x(), level.velocity.y(), level.velocity.z()});
    if (const auto& attitude = scene.payload.drag_area_table) {
        contents.add("attitude", attitude->angle());
        contents.add("drag area by attitude", attitude->area());
    }
    for (const Parachute& chute : scene.parachutes) {
        contents.add(chute.fabric);
        for (const PanelMaterials& panel : chute.panel)
            contents.add(panel.fabric);
        for (const Cord* cord : {&chute.line, &chute.tapes.radial, &chute.tapes.skirt, &chute.tapes.vent})
            contents.add(*cord);
        if (chute.vent_lines) contents.add(chute.vent_lines->cord);
        if (const auto& growth = chute.drag_area_table) {
            contents.add("growth over fraction", growth->fraction());
            contents.add("growth", growth->ratio());
        }
        if (const auto& by_mach = chute.drag_area_mach_table) {
            contents.add("Mach number", by_mach->mach());
            contents.add("factor", by_mach->factors());
        }
        if (const auto& calibration = chute.calibration) {
            for (const DropConditions& run : calibration->runs())
                contents.add("calibrated at", {run.payload_mass, run.airspeed, run.density});
            for (const CalibratedFactors& input : calibration->inputs())
                contents.add(input.key, input.factor);
        }
        contents.add(chute.fill_time);
        for (const Reefing& stage : chute.reefing)
            if (stage.fill_time) contents.add(*stage.fill_time);
        contents.add("extraction time", chute.deploy.extraction.time);
        contents.add("extraction force", chute.deploy.extraction.force);
    }
    return sha256_hex(write_scene(same) + contents.text());
}

}  // namespace twinchute
