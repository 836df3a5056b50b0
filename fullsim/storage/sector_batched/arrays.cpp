#include "fullsim/storage/sector_batched/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "fullsim/forces/gore_contact.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gore_contacts.hpp"

namespace twinchute::fullsim {
namespace {

template <std::size_t corners>
using Nodes = std::array<LocalNode, corners>;

template <std::size_t corners>
Nodes<corners> next(Nodes<corners> nodes) {
    for (LocalNode& n : nodes)
        ++n;
    return nodes;
}

/// Elements by their nodes, and those that are still to be had.
template <std::size_t corners>
class Remaining {
public:
    explicit Remaining(const std::vector<Nodes<corners>>& elements) {
        for (std::size_t e = 0; e < elements.size(); ++e)
            at_[elements[e]].push_back(static_cast<int>(e));
    }
    /// -1 where there is none.
    int take(const Nodes<corners>& nodes) {
        const auto found = at_.find(nodes);
        if (found == at_.end() || found->second.empty()) return -1;
        const int element = found->second.back();
        found->second.pop_back();
        return element;
    }
    bool has(const Nodes<corners>& nodes) const {
        const auto found = at_.find(nodes);
        return found != at_.end() && !found->second.empty();
    }

private:
    std::map<Nodes<corners>, std::vector<int>> at_;
};

}  // namespace

/// Elements that are worked on side by side.
template <std::size_t corners>
struct SectorArrays::Group {
    std::array<std::int32_t, corners> node{};
    std::vector<int> element;
    bool in_remainder = false;
};

/// Runs as long as there are any. What would leave most of a register empty, at the end of a run or alone,
/// goes to the remainder loop; of chains, which pull on their nodes more often, single elements alone.
template <std::size_t corners>
std::vector<SectorArrays::Group<corners>> SectorArrays::groups(
    const std::vector<std::array<LocalNode, corners>>& elements, std::vector<NodeCopy>& copies, bool chains) {
    Remaining<corners> remaining(elements);
    std::vector<Group<corners>> all;
    Group<corners> remainder;
    remainder.in_remainder = true;
    for (const Nodes<corners>& start : elements) {
        Nodes<corners> before = start;
        for (LocalNode& n : before)
            --n;
        if (!remaining.has(start) || remaining.has(before)) continue;
        Group<corners> run{start, {}, false};
        for (Nodes<corners> at = start; remaining.has(at); at = next(at))
            run.element.push_back(remaining.take(at));
        const auto count = static_cast<int>(run.element.size()), left = count % lanes_;
        if (left <= lanes_ / 4 && !(chains && count > 1))
            for (int k = 0; k < left; ++k) {
                remainder.element.push_back(run.element.back());
                run.element.pop_back();
            }
        if (!run.element.empty()) all.push_back(std::move(run));
    }
    if (!remainder.element.empty()) {
        for (auto& first : remainder.node) {
            first = nodes_;
            nodes_ += padded(static_cast<int>(remainder.element.size()));
        }
        for (std::size_t c = 0; c < corners; ++c)
            for (std::size_t k = 0; k < remainder.element.size(); ++k)
                copies.push_back(
                    {remainder.node[c] + static_cast<std::int32_t>(k), elements[remainder.element[k]][c]});
        all.push_back(std::move(remainder));
    }
    return all;
}

/// Number of lanes in all registers that the groups fill.
template <std::size_t corners>
int SectorArrays::lanes_in(const std::vector<Group<corners>>& groups) const {
    int registers = 0;
    for (const auto& group : groups)
        registers += padded(static_cast<int>(group.element.size())) / lanes_;
    return (registers + unroll_factor_ - 1) / unroll_factor_ * unroll_factor_ * lanes_;
}

SectorArrays::SectorArrays(const Sector& sector, const Mesh& mesh, const NodeConstants& constants,
                           const FullSettings& settings, int lanes, int unroll_factor)
    : lanes_(lanes), unroll_factor_(unroll_factor), nodes_(sector.nodes()) {
    lay_triangles(sector, membrane_law(mesh.fabric, settings.bulk_viscosity));
    lay_cables(sector, mesh, settings.bulk_viscosity, settings.beta);
    if (settings.contact == Contact::gores) lay_contacts(sector, mesh);
    lay_halo(sector);
    lay_nodes(sector, constants);
    collect_sources(sector);
}

std::vector<PlanArray> SectorArrays::sizes() const {
    std::vector<PlanArray> all;
    add_bytes(all, "nodes of the sector", node_rows_.bytes() + node_arrays_.bytes());
    add_bytes(all, "triangles", triangle_rows_.bytes());
    add_bytes(all, "tapes", tape_constants_.bytes());
    add_bytes(all, "lines", cord_constants_.bytes() + line_rows_.bytes());
    add_bytes(all, "gore contact", contact_rows_.bytes());
    add_bytes(all, "buffers", buffer_rows_.bytes());
    return all;
}

/// Before and behind it lie zeros, as many as a register has: nodes may ask beyond its ends.
std::int32_t SectorArrays::new_buffer(int elements) {
    const std::int32_t at = buffers_ + lanes_;
    buffers_ = at + padded(elements);
    return at;
}

/// One that is there to fill up has no elements: it reads the first node and writes zeros where zeros are.
template <std::size_t corners, std::size_t buffers>
void SectorArrays::lay(std::vector<ElementBatch<corners, buffers>>& batches, const Group<corners>& group,
                       const std::array<std::int32_t, buffers>& element_force) const {
    ElementBatch<corners, buffers> next{group.node, element_force};
    for (std::size_t k = 0; k < group.element.size(); k += lanes_) {
        batches.push_back(next);
        for (std::int32_t& node : next.node)
            node += lanes_;
        for (std::int32_t& s : next.element_force)
            s += lanes_;
    }
}

void SectorArrays::lay_triangles(const Sector& sector, const MembraneLaw& law) {
    std::vector<Nodes<3>> nodes;
    for (const GoreTriangle& t : sector.triangles)
        nodes.push_back(t.node);
    const auto all = groups(nodes, plan.copies, false);
    enum : int {
        inverse_a,
        inverse_c,
        b_over_a,
        area,
        viscosity,
        half,
        stiffness = first_stiffness_row,
        damping = stiffness + 3
    };
    triangle_rows_ = AlignedRows(damping + 3, lanes_in(all));
    AlignedRows& rows = triangle_rows_;
    std::int32_t first = 0;
    for (const auto& group : all) {
        const auto count = static_cast<int>(group.element.size());
        std::array<std::int32_t, 4> element_force;
        for (std::int32_t& s : element_force)
            s = new_buffer(count);
        const std::int32_t push = element_force[3];
        for (int k = 0; k < count; ++k) {
            const GoreTriangle& t = sector.triangles[group.element[k]];
            const Triangle flat{{}, 0, t.a, t.b, t.c};
            const int at = first + k;
            unstrained_.push_back({at, group.element[k], unstrained_rows(law, flat)});
            rows[inverse_a][at] = 1.0 / t.a;
            rows[inverse_c][at] = 1.0 / t.c;
            rows[b_over_a][at] = t.b / t.a;
            rows[area][at] = flat.area();
            rows[viscosity][at] = law.viscosity * element_length(flat);
            rows[half][at] = 0.5;
        }
        for (int c = 0; c < 3; ++c) {
            if (!group.in_remainder) {
                acts_.push_back(
                    {c == 0 ? Act::What::plus : Act::What::minus, element_force[c], group.node[c], count});
                acts_.push_back({Act::What::push, push, group.node[c], count});
                continue;
            }
            for (int k = 0; k < count; ++k) {
                const LocalNode node = sector.triangles[group.element[k]].node[c];
                plan.remainder_triangles.push_back({element_force[c] + k, node, c == 0 ? 1.0 : -1.0});
                plan.remainder_pushes.push_back({push + k, node, 1.0});
            }
        }
        lay(plan.triangles, group, element_force);
        first += padded(count);
    }
    pair_up(plan.triangles);
    frame.triangle = {rows[inverse_a],
                      rows[inverse_c],
                      rows[b_over_a],
                      rows[area],
                      rows[viscosity],
                      rows[half],
                      {rows[stiffness], rows[stiffness + 1], rows[stiffness + 2]},
                      {rows[damping], rows[damping + 1], rows[damping + 2]}};
}

void SectorArrays::lay_cables(const Sector& sector, const Mesh& mesh, double bulk_viscosity, double beta) {
    std::vector<GoreCable> tapes, cords, lines;
    for (const GoreCable& c : sector.cables) {
        (is_tape(c.kind) ? tapes : cords).push_back(c);
        if (c.kind == CableKind::line) lines.push_back(c);
    }
    const auto nodes = [](const std::vector<GoreCable>& cables) {
        std::vector<Nodes<2>> of;
        for (const GoreCable& c : cables)
            of.push_back(c.node);
        return of;
    };
    const auto of_tapes = groups(nodes(tapes), plan.copies, false),
               of_cords = groups(nodes(cords), plan.cord_copies, true),
               of_lines = groups(nodes(lines), plan.copies, false);
    enum : int { inverse_length, stiffness, dashpot, rest_length, line, rows_of_cables };
    tape_constants_ = AlignedRows(rows_of_cables, lanes_in(of_tapes));
    cord_constants_ = AlignedRows(rows_of_cables, lanes_in(of_cords));
    line_rows_ = AlignedRows(1, lanes_in(of_lines));
    const auto lay_all = [&](const std::vector<GoreCable>& cables, const std::vector<Group<2>>& all,
                             AlignedRows& rows, std::vector<CableBatch>& batches,
                             std::vector<RemainderPull>& remainder, Act::What plus, Act::What minus,
                             std::vector<CableTangent>& tangents) {
        std::int32_t first = 0;
        for (const auto& group : all) {
            const auto count = static_cast<int>(group.element.size());
            const std::int32_t element_force = new_buffer(count);
            for (int k = 0; k < count; ++k) {
                const GoreCable& c = cables[group.element[k]];
                const CableConstants constants = cable_constants(
                    mesh, {{c.node[0], c.node[1]}, c.rest_length, c.strands, c.kind}, bulk_viscosity, beta);
                const int at = first + k;
                rows[inverse_length][at] = 1.0 / c.rest_length;
                rows[stiffness][at] = constants.stiffness;
                rows[dashpot][at] = constants.dashpot;
                rows[rest_length][at] = c.rest_length;
                rows[line][at] = c.kind == CableKind::line ? 1.0 : 0.0;
                tangents.push_back({c.node, constants.stiffness / c.rest_length, constants.dashpot});
                if (group.in_remainder)
                    for (int end = 0; end < 2; ++end)
                        remainder.push_back({element_force + k, c.node[end], end == 0 ? 1.0 : -1.0});
            }
            if (!group.in_remainder) {
                acts_.push_back({plus, element_force, group.node[0], count});
                acts_.push_back({minus, element_force, group.node[1], count});
            }
            lay<2, 1>(batches, group, {element_force});
            first += padded(count);
        }
        pair_up(batches);
        return CableConstantsRow{rows[inverse_length], rows[stiffness], rows[dashpot], rows[rest_length],
                                 rows[line]};
    };
    using enum Act::What;
    frame.tape = lay_all(tapes, of_tapes, tape_constants_, plan.tapes, plan.remainder_tapes, plus, minus,
                         tape_tangents_);
    frame.cord = lay_all(cords, of_cords, cord_constants_, plan.cords, plan.remainder_cords, cord_plus,
                         cord_minus, cord_tangents_);
    std::int32_t first = 0;
    for (const auto& group : of_lines) {
        const auto count = static_cast<int>(group.element.size());
        const std::int32_t element_force = new_buffer(count);
        std::fill_n(line_rows_[0] + first, count, 1.0);
        for (int end = 0; end < 2; ++end) {
            if (!group.in_remainder) acts_.push_back({aero, element_force, group.node[end], count});
            for (int k = 0; group.in_remainder && k < count; ++k)
                plan.remainder_lines.push_back({element_force + k, lines[group.element[k]].node[end], 1.0});
        }
        lay<2, 1>(plan.lines, group, {element_force});
        first += padded(count);
    }
    pair_up(plan.lines);
    frame.line = line_rows_[0];
}

void SectorArrays::lay_contacts(const Sector& sector, const Mesh& mesh) {
    std::unordered_map<NodeIndex, LocalNode> local;
    for (LocalNode n = 0; n < sector.own; ++n)
        local.emplace(sector.node[n], n);
    for (std::size_t k = 0; k < sector.seam.size(); ++k)
        local.emplace(sector.node[sector.own + sector.seam[k]],
                      sector.first_halo() + static_cast<LocalNode>(k));
    const auto pairs = local_contacts(mesh, sector.gores, local);
    std::vector<Nodes<2>> nodes;
    for (const auto& pair : pairs) {
        nodes.push_back(pair.node);
        tape_tangents_.push_back({pair.node, contact_tangent(pair.stiffness), 0.0});
    }
    const auto all = groups(nodes, plan.copies, false);
    contact_rows_ = AlignedRows(1, lanes_in(all));
    std::int32_t first = 0;
    for (const auto& group : all) {
        const auto count = static_cast<int>(group.element.size());
        const std::array<std::int32_t, 2> element_force{new_buffer(count), new_buffer(count)};
        for (int k = 0; k < count; ++k) {
            const auto& [node, stiffness] = pairs[group.element[k]];
            contact_rows_[0][first + k] = stiffness;
            for (int end = 0; group.in_remainder && end < 2; ++end)
                plan.remainder_contacts.push_back({element_force[end] + k, node[end], -1.0});
        }
        for (int end = 0; !group.in_remainder && end < 2; ++end)
            acts_.push_back({Act::What::minus, element_force[end], group.node[end], count});
        lay(plan.contacts, group, element_force);
        first += padded(count);
    }
    pair_up(plan.contacts);
    frame.contact = contact_rows_[0];
}

void SectorArrays::lay_halo(const Sector& sector) {
    SeamHalo& halo = plan.halo;
    halo.seam = sector.seam.front();
    halo.first = sector.first_halo();
    halo.nodes = static_cast<std::int32_t>(sector.seam.size());
    halo.cosine = std::cos(sector.turn);
    halo.sine = std::sin(sector.turn);
    halo.pull = new_buffer(padded(halo.nodes + (unroll_factor_ - 1) * lanes_));  // written interleaved
    halo.push = new_buffer(padded(halo.nodes + (unroll_factor_ - 1) * lanes_));
    acts_.push_back({Act::What::plus, halo.pull, halo.seam, halo.nodes});
    acts_.push_back({Act::What::push, halo.push, halo.seam, halo.nodes});
}

void SectorArrays::lay_nodes(const Sector& sector, const NodeConstants& constants) {
    // A register that has no node of its own reads and writes behind the last.
    const std::size_t length = nodes_ + unroll_factor_ * lanes_, buffers = buffers_ + unroll_factor_ * lanes_;
    node_arrays_ = AlignedRows(27, length);
    int row = 0;
    for (Components* array : {&frame.x, &frame.v, &frame.v_half, &frame.pull, &frame.push, &frame.aero,
                              &frame.cord_pull, &frame.slow})
        for (double*& component : *array)
            component = node_arrays_[row++];
    frame.inverse = node_arrays_[row++];
    for (double*& extra : frame.row_extra)
        extra = node_arrays_[row++];
    buffer_rows_ = AlignedRows(5, buffers);
    for (int c = 0; c < 3; ++c)
        frame.element_force[c] = buffer_rows_[c];
    for (int what = 0; what < 2; ++what)
        frame.element_rows[what] = buffer_rows_[3 + what];

    enum : int {
        mass,
        canopy_mass,
        inertia,
        share,
        across,
        along,
        on_cord,
        stiffness = cable_stiffness_row,
        damping,
        cord_stiffness,
        cord_damping,
        rows
    };
    node_rows_ = AlignedRows(rows, length);
    std::fill_n(node_rows_[inertia], length, 1.0);
    for (LocalNode n = 0; n < sector.own; ++n) {
        const NodeIndex i = sector.node[n];
        const double part = sector.on_axis[n] ? 1.0 / sector.count : 1.0;
        node_rows_[mass][n] = node_rows_[inertia][n] = part * constants.mass[i];
        if (i < constants.canopy_nodes) node_rows_[canopy_mass][n] = part * constants.mass[i];
        node_rows_[share][n] = constants.share[i];
        node_rows_[across][n] = sector.on_axis[n] ? 0.0 : 1.0;
        node_rows_[along][n] = 1.0;
    }
    for (const CableTangent& c : cord_tangents_)
        for (const LocalNode n : c.node)
            if (n < sector.own) node_rows_[on_cord][n] = 1.0;
    frame.node = {node_rows_[mass],           node_rows_[canopy_mass], node_rows_[inertia],
                  node_rows_[share],          node_rows_[across],      node_rows_[along],
                  node_rows_[on_cord],        node_rows_[stiffness],   node_rows_[damping],
                  node_rows_[cord_stiffness], node_rows_[cord_damping]};
}

void SectorArrays::weigh(const Sector& sector, const std::vector<double>& weight) {
    const SeamHalo& halo = plan.halo;
    const auto own = [&](LocalNode n) {
        const bool in_halo = halo.first <= n && n < halo.first + halo.nodes;
        return in_halo ? n - halo.first + halo.seam : n;
    };
    const auto of = [&](LocalNode n) { return weight[own(n)]; };
    for (const UnstrainedRow& row : unstrained_) {
        const auto& node = sector.triangles[row.triangle].node;
        const std::array<double, 3> weights{of(node[0]), of(node[1]), of(node[2])};
        for (int c = 0; c < 3; ++c) {
            const double stiffness = row.of_triangle.stiffness(c, weights);
            triangle_rows_[first_stiffness_row + c][row.at] = stiffness;
            triangle_rows_[first_stiffness_row + 3 + c][row.at] = row.of_triangle.damping * stiffness;
        }
    }
    for (int row = 0; row < 4; ++row)
        std::fill_n(node_rows_[cable_stiffness_row + row], sector.own + 1, 0.0);
    for (const auto& [tangents, row] : {std::pair{&tape_tangents_, cable_stiffness_row},
                                        std::pair{&cord_tangents_, cable_stiffness_row + 2}})
        for (const CableTangent& c : *tangents)
            for (int end = 0; end < 2; ++end) {
                const double columns = 1.0 + of(c.node[1 - end]) / of(c.node[end]);
                node_rows_[row][own(c.node[end])] += columns * c.stiffness;
                node_rows_[row + 1][own(c.node[end])] += columns * c.damping;
            }
}

std::vector<SectorArrays::CordRow> SectorArrays::cord_rows() const {
    std::map<LocalNode, CordRow> of;
    for (const CableTangent& c : cord_tangents_)
        for (const LocalNode n : c.node) {
            CordRow& row = of.try_emplace(n, CordRow{n}).first->second;
            row.stiffness += 2.0 * c.stiffness;
            row.damping += 2.0 * c.damping;
        }
    std::vector<CordRow> rows;
    for (const auto& [node, row] : of)
        rows.push_back(row);
    return rows;
}

/// Sources of a register that begins at node `first`.
NodeSources SectorArrays::sources_of(int first, int nodes) {
    const auto collect = [&](Act::What what) {
        for (const Act& act : acts_)
            if (act.what == what && first < act.node + act.elements && act.node < first + nodes)
                plan.sources.push_back(act.element_force + first - act.node);
        return static_cast<std::int32_t>(plan.sources.size());
    };
    NodeSources s;
    s.plus = static_cast<std::int32_t>(plan.sources.size());
    s.minus = collect(Act::What::plus);
    s.push = collect(Act::What::minus);
    s.aero = collect(Act::What::push);
    s.cord_plus = collect(Act::What::aero);
    s.cord_minus = collect(Act::What::cord_plus);
    s.end = collect(Act::What::cord_minus);
    const auto touched = [&](std::initializer_list<const std::vector<RemainderPull>*> all) {
        return std::ranges::any_of(all, [&](const auto* remainder) {
            return std::ranges::any_of(*remainder, [&](const RemainderPull& pull) {
                return first <= pull.to && pull.to < first + nodes;
            });
        });
    };
    s.extra = touched({&plan.remainder_triangles, &plan.remainder_tapes, &plan.remainder_contacts,
                       &plan.remainder_pushes, &plan.remainder_lines});
    s.remainder_cord = touched({&plan.remainder_cords});
    return s;
}

void SectorArrays::collect_sources(const Sector& sector) {
    // The payload's are not the sector's to add up.
    std::erase_if(plan.remainder_cords, [&](const RemainderPull& pull) {
        if (pull.to == sector.payload()) payload.push_back(pull);
        return pull.to == sector.payload();
    });
    SeamHalo& halo = plan.halo;
    for (int n = 0; n < halo.nodes; n += lanes_)
        halo.sources.push_back(sources_of(halo.first + n, std::min(lanes_, halo.nodes - n)));
    pair_up(halo.sources);
    for (int n = 0; n < sector.own; n += lanes_)
        plan.own.push_back(sources_of(n, std::min(lanes_, sector.own - n)));
    pair_up(plan.own);
    for (std::size_t k = 0; k < plan.own.size(); ++k) {
        const auto first = static_cast<std::int32_t>(k / unroll_factor_ * unroll_factor_) * lanes_;
        if ((plan.own[k].cord_plus < plan.own[k].end || plan.own[k].remainder_cord) &&
            (plan.on_cord.empty() || plan.on_cord.back() != first))
            plan.on_cord.push_back(first);
    }

    for (const Act& act : acts_)
        if ((act.what == Act::What::cord_plus || act.what == Act::What::cord_minus) &&
            act.node <= sector.payload() && sector.payload() < act.node + act.elements)
            payload.push_back({act.element_force + sector.payload() - act.node, sector.payload(),
                               act.what == Act::What::cord_plus ? 1.0 : -1.0});
}

}  // namespace twinchute::fullsim
