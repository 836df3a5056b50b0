#include "fullsim/serialize_state.hpp"

#include <algorithm>
#include <span>

#include "lib/math/sha256.hpp"

namespace twinchute::fullsim {
namespace {

constexpr std::size_t most_near_pairs = 100'000'000;  // of a checkpoint that is sound

// Structs are taken apart by name and in full: a member that is added and not kept does not compile.

constexpr auto sums_members = [](NodeSums& sums, auto&& each) {
    auto& [canopy_position, canopy_velocity, system_position, system_velocity, canopy_area_velocity] = sums;
    for (Vec3* x :
         {&canopy_position, &canopy_velocity, &system_position, &system_velocity, &canopy_area_velocity})
        each(*x);
};

void serialize_air(Archive& archive, AeroState& air) {
    auto& [density, viscosity, wind, wind_at_payload, direction, airspeed, dynamic_pressure, drag_area,
           radial_pressure, projected_area, signed_area, pressure, pressure_capped, extraction] = air;
    archive.numbers("wind", std::span(wind.data(), 3));
    archive.numbers("wind at the payload", std::span(wind_at_payload.data(), 3));
    archive.numbers("direction of the air", std::span(direction.data(), 3));
    for (double* x : {&density, &viscosity, &airspeed, &dynamic_pressure, &drag_area, &radial_pressure,
                      &projected_area, &signed_area, &pressure})
        archive.number("air", *x);
    archive.flag("pressure is capped", pressure_capped);
    archive.numbers("extraction", std::span(extraction.data(), 3));
}

void serialize_body(Archive& archive, std::optional<BodyState>& body) {
    bool turns = body.has_value();
    archive.flag("payload turns", turns);
    if (!turns) return body.reset();
    if (!body) body.emplace();
    auto& [attitude, half_momentum, momentum, torque] = *body;
    archive.numbers("attitude", std::span(attitude));
    archive.numbers("momentum of the half step", std::span(half_momentum.data(), 3));
    archive.numbers("momentum", std::span(momentum.data(), 3));
    archive.numbers("torque", std::span(torque.data(), 3));
}

constexpr auto energy_members = [](EnergyTotals& totals, auto&& each) {
    auto& [kinetic_start, elastic_start, gravity_work, drag_work, damping, added_mass, gravity_power,
           drag_power, damping_power, external_work, external_power, air_loss, air_loss_power, ramp, weighs,
           kinetic, changed_hands] = totals;
    for (double* x : {&kinetic_start, &elastic_start, &gravity_work, &drag_work, &damping, &added_mass,
                      &gravity_power, &drag_power, &damping_power, &external_work, &external_power, &air_loss,
                      &air_loss_power, &ramp, &changed_hands})
        each(*x);
};

void serialize_contact(Archive& archive, SelfContactState& contact) {
    auto& [pairs, looked_at, look_time, velocity_gradient, searches, skin, spent, passed, deepest, listed,
           all, awake, attention, measured] = contact;
    static_cast<void>(all), static_cast<void>(awake), static_cast<void>(attention),
        static_cast<void>(measured);
    archive.length("near pairs", pairs, most_near_pairs);
    for (NearPair& pair : pairs) {
        auto& [node, triangle, side, thickness, slack] = pair;
        archive.whole("node", node, 0);
        archive.whole("triangle", triangle, 0);
        archive.whole("side", side, -1, 1);
        archive.number("thickness", thickness);
        archive.number("slack", slack);
    }
    archive.numbers("nodes at the last look", looked_at);
    archive.number("time of the last look", look_time);
    archive.numbers("velocity gradient", std::span(velocity_gradient.data(), 9));
    archive.whole("searches", searches, 0);
    archive.number("skin", skin);
    archive.number("spent", spent);
    archive.whole("passed", passed, 0);
    archive.number("deepest", deepest);
    if (archive.reads()) listed = false;
}

/// Records of whole rows of doubles.
template <class Record>
std::span<double> doubles(std::vector<Record>& records) {
    return {reinterpret_cast<double*>(records.data()), records.size() * (sizeof(Record) / sizeof(double))};
}

}  // namespace

void serialize(Archive& archive, LargestLoads& loads) {
    archive.row("largest loads", loads, [](LargestLoads& of, auto&& each) {
        auto& [line_tension, fabric_stress, last_stress] = of;
        each(line_tension), each(fabric_stress), each(last_stress);
    });
}

void serialize(Archive& archive, State& state) {
    auto& [time, dt, line_dt, step, phase, stage, folded, fe_weight, added_mass_rate, added_mass,
           largest_added_mass, body, sums, air, inflow, energy, accretion_power, damping_power,
           external_power, riser_force, in_subcycles, capped_steps, largest, contact] =
        static_cast<SystemState&>(state);
    auto& [node, v_half, force, aero, contact_reaction] = static_cast<NodeArrays&>(state);
    for (double* x : {&time, &dt, &line_dt, &fe_weight, &added_mass_rate, &added_mass, &largest_added_mass,
                      &accretion_power, &damping_power, &external_power})
        archive.number("state", *x);
    archive.whole("step", step, 0);
    archive.whole("capped steps", capped_steps, 0);
    archive.choice("phase", phase, Phase::open);
    archive.choice("stage", stage, Stage::flight);
    archive.flag("folded", folded);
    archive.flag("has been full", inflow.has_been_full);
    archive.numbers("nodes", doubles(node));
    archive.numbers("velocities of half steps", doubles(v_half));
    archive.numbers("forces", doubles(force.held()));
    archive.numbers("forces of the air", doubles(aero.held()));
    serialize_body(archive, body);
    archive.row("sums", sums, sums_members);
    serialize_air(archive, air);
    archive.row("inflow", inflow, [](InflowState& of, auto&& each) {
        auto& [has_been_full, volume, swept, mobility, mouth, ratio, leak, steady_drag_area, inside,
               last_inside, displaced, other_pull, mean_pull, mean_of_means, last_dt, loss, noted_at,
               past_pressure] = of;
        static_cast<void>(has_been_full);
        for (double* number : {&volume, &swept, &mobility, &mouth, &ratio, &leak, &steady_drag_area, &inside,
                               &last_inside, &displaced, &other_pull, &mean_pull, &mean_of_means, &last_dt,
                               &loss, &noted_at, &past_pressure[0], &past_pressure[1]})
            each(*number);
    });
    archive.row("energy", energy, energy_members);
    archive.numbers("riser force", std::span(riser_force.data(), 3));
    archive.numbers("risers in subcycles", std::span(in_subcycles.sum.data(), 3));
    archive.whole("risers in subcycles", in_subcycles.count, 0);
    serialize(archive, largest);
    serialize_contact(archive, contact);
}

std::string mesh_digest(const Mesh& mesh) {
    Archive archive;  // for its bytes
    std::vector<double> numbers;
    for (const Vec3& x : mesh.position)
        numbers.insert(numbers.end(), x.begin(), x.end());
    for (const auto* of_nodes : {&mesh.mass, &mesh.tributary_area})
        numbers.insert(numbers.end(), of_nodes->begin(), of_nodes->end());
    for (const Triangle& t : mesh.triangles)
        numbers.insert(numbers.end(), {1.0 * t.node[0], 1.0 * t.node[1], 1.0 * t.node[2], t.a, t.b, t.c});
    for (std::size_t c = 0; c < mesh.cables.size(); ++c) {
        const Cable& cable = mesh.cables[c];
        const bool is_cut = std::ranges::binary_search(mesh.reefing_line, c);
        numbers.insert(numbers.end(), {1.0 * cable.node[0], 1.0 * cable.node[1], cable.strands,
                                       1.0 * static_cast<int>(cable.kind), is_cut ? 0.0 : cable.rest_length});
    }
    if (mesh.body) {
        for (const Vec3& x : mesh.body->solid.node)
            numbers.insert(numbers.end(), x.begin(), x.end());
        for (const auto& corner : mesh.body->solid.tetrahedron)
            numbers.insert(numbers.end(), corner.begin(), corner.end());
    }
    for (int sheet = 0; sheet < mesh.sheets(); ++sheet) {
        const Fabric& fabric = mesh.fabric_of(sheet);
        numbers.insert(numbers.end(),
                       {fabric.density, fabric.youngs_modulus, fabric.poisson_ratio, fabric.thickness});
        for (std::size_t t = 0; sheet > 0 && t < mesh.triangles.size(); ++t)
            if (mesh.triangles[t].sheet == sheet) numbers.push_back(static_cast<double>(t));
    }
    for (const Cord& cord : mesh.cords)
        numbers.insert(numbers.end(), {cord.density, cord.youngs_modulus, cord.diameter});
    archive.numbers("mesh", numbers);
    return sha256_hex(archive.take());
}

}  // namespace twinchute::fullsim
