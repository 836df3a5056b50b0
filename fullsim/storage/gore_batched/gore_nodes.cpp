#include "fullsim/storage/gore_batched/gore_nodes.hpp"

#include <algorithm>
#include <numeric>

namespace twinchute::fullsim {

GoreNodes::GoreNodes(const Gores& gores, int lanes, What what) : gores_(gores) {
    const bool everything = what != What::row_sums, both = what == What::pushed_and_dragged;
    frame.components = both ? 15 : everything ? 12 : 2;
    frame.lanes = lanes;
    frame.blocks = frame.last = (gores.count + lanes - 1) / lanes;
    frame.own = everything ? gores.own : gores.canopy;
    frame.nodes = gores.local_nodes() - gores.own + frame.own;
    if (!everything) frame.nodes -= static_cast<int>(gores.shared.size());
    frame.canopy = gores.canopy;
    frame.gores = gores.count;
    const std::size_t nodes = frame.at(frame.blocks, 0), row = static_cast<std::size_t>(lanes);
    const std::size_t half_steps = everything ? frame.half_at(frame.blocks, 0) : 0;
    const std::size_t all = nodes + half_steps + 7 * frame.blocks * row;
    memory_.assign(all / Line{}.size() + 1, Line{});
    shared_.resize(frame.blocks);
    for (std::size_t k = 0; everything && k < gores.shared.size(); ++k)
        for (int gore = 0; gore < gores.count; ++gore) {
            auto& of_block = shared_[gore / lanes];
            const LocalNode local = first_shared() + static_cast<LocalNode>(k);
            const NodeIndex node = gores.shared[k][gore];
            if (!of_block.empty() && of_block.back().node == node && of_block.back().local == local)
                ++of_block.back().last;
            else
                of_block.push_back({node, local, gore, gore + 1});
        }
    // Three arrays of what is handed over, places and velocities of what is shown, two arrays of what is done
    // to shared nodes; each block has lines of its own.
    std::size_t most = 0;
    for (const auto& of_block : shared_)
        most = std::max(most, 15 * gores.neighbour.size() + 6 * of_block.size());
    const std::size_t edge_lines = (most + Line{}.size() - 1) / Line{}.size();
    if (everything) edge_.assign(frame.blocks * edge_lines, Line{});
    edge_length_ = edge_lines * Line{}.size();
    double* const begin = memory_.front().data();
    double* next = begin;
    // Arrays that a triangle reads and writes come first.
    double** const all_arrays[] = {&frame.x, &frame.v, &frame.force, &frame.push, &frame.aero};
    for (int k = 0; 3 * k < frame.components; ++k, next += 3 * row)
        *all_arrays[k] = next;
    if (!both) frame.aero = frame.push;
    next = begin + nodes;
    if (everything) frame.v_half = next;
    next += half_steps;
    std::fill_n(next, gores.count, 1.0);
    frame.live = next;
    frame.pull = next + frame.blocks * row;
    if (what == What::pushed) {
        frame.skirt_aero = next + 4 * frame.blocks * row;
        frame.skirt_stride = 3 * row;
    } else if (everything) {
        frame.skirt_aero = frame.aero + frame.at(0, gores.inner);
        frame.skirt_stride = frame.at(1, 0);
    }
    for (int gore = 0; gore < frame.blocks * lanes; ++gore)
        first_.push_back(frame.at(gore / lanes, 0) + static_cast<std::size_t>(gore % lanes));
    halo_.assign(gores.canopy, -1);
    for (std::size_t k = 0; k < gores.neighbour.size(); ++k)
        halo_[gores.neighbour[k]] = gores.own + static_cast<std::int32_t>(k);
}

void GoreNodes::send_halo_forces(int block, std::span<double* const> arrays) const {
    double* to = handed(block);
    const int gore = last_gore(block);
    for (double* array : arrays) {
        const double* halo = &at(array, gores_.own, gore, 0);
        for (std::size_t k = 0; k < gores_.neighbour.size(); ++k, halo += frame.stride())
            for (int c = 0; c < 3; ++c)
                *to++ = halo[c * frame.lanes];
    }
}

void GoreNodes::receive_halo_forces(int block, std::span<double* const> arrays) const {
    const double* from = handed(before(block));
    const int gore = block * frame.lanes;
    for (double* array : arrays)
        for (const LocalNode n : gores_.neighbour) {
            double* const own = &at(array, n, gore, 0);
            for (int c = 0; c < 3; ++c)
                own[c * frame.lanes] += *from++;
        }
}

void GoreNodes::send_first_gore(int block) const {
    double* to = shown(block);
    const int gore = block * frame.lanes;
    for (double* array : {frame.x, frame.v})
        for (const LocalNode n : gores_.neighbour) {
            const double* const own = &at(array, n, gore, 0);
            for (int c = 0; c < 3; ++c)
                *to++ = own[c * frame.lanes];
        }
}

void GoreNodes::gather_halo(int block) const {
    const double* from = shown(after(block));
    const int gore = last_gore(block);
    for (double* array : {frame.x, frame.v}) {
        double* halo = &at(array, gores_.own, gore, 0);
        for (std::size_t k = 0; k < gores_.neighbour.size(); ++k, halo += frame.stride())
            for (int c = 0; c < 3; ++c)
                halo[c * frame.lanes] = *from++;
    }
}

const GoreFrame& GoreNodes::up_to_date(const State& state) const {
    for (int block = 0; block < frame.blocks; ++block) {
        gather_halo(block);
        gather_shared(state, block);
    }
    return frame;
}

void GoreNodes::gather_halo_within(int block) const {
    for (int gore = block * frame.lanes; gore < last_gore(block); ++gore)
        for (double* array : {frame.x, frame.v})
            for (std::size_t k = 0; k < gores_.neighbour.size(); ++k)
                for (int c = 0; c < 3; ++c)
                    at(array, gores_.own + static_cast<LocalNode>(k), gore, c) =
                        at(array, gores_.neighbour[k], gore + 1, c);
}

void GoreNodes::load(const State& state) const {
    const int all = frame.blocks * frame.lanes;
    for (int gore = 0; gore < all; ++gore)
        for (LocalNode n = 0; n < gores_.own; ++n) {
            // A lane without a gore looks like the first one, and stays so.
            const NodeIndex i = gores_.node[(gore < gores_.count ? gore : 0) * gores_.own + n];
            for (int c = 0; c < 3; ++c) {
                at(frame.x, n, gore, c) = state.node[i].x[c];
                at(frame.v, n, gore, c) = state.node[i].v[c];
                half_at(n, gore, c) = state.v_half[i].value[c];
            }
        }
    for (int block = 0; block < frame.blocks; ++block) {
        gather_shared(state, block);
        gather_halo_within(block);
        send_first_gore(block);
    }
}

void GoreNodes::store(State& state) const {
    // Gore by gore within a node: its numbers lie side by side.
    for (LocalNode n = 0; n < gores_.own; ++n)
        for (int gore = 0; gore < gores_.count; ++gore) {
            const NodeIndex i = gores_.node[gore * gores_.own + n];
            for (int c = 0; c < 3; ++c) {
                state.node[i].x[c] = at(frame.x, n, gore, c);
                state.node[i].v[c] = at(frame.v, n, gore, c);
                state.v_half[i].value[c] = half_at(n, gore, c);
            }
        }
}

std::vector<GoreNodes::OwnNode> GoreNodes::own_nodes(const std::vector<bool>* marks) const {
    std::vector<OwnNode> nodes;
    // Gore by gore within a node: its numbers lie side by side.
    for (LocalNode n = 0; n < gores_.own; ++n)
        for (int gore = 0; gore < gores_.count; ++gore)
            if (const NodeIndex i = gores_.node[gore * gores_.own + n]; !marks || (*marks)[i])
                nodes.push_back({i, n, gore, static_cast<std::size_t>(&at(frame.x, n, gore, 0) - frame.x)});
    return nodes;
}

void GoreNodes::store_places(State& state, std::span<const OwnNode> nodes) const {
    const double *const x = frame.x, *const v = frame.v;
    const auto y = static_cast<std::size_t>(frame.lanes), z = 2 * y;
    NodeRecord* const record = state.node.data();
    for (const OwnNode& own : nodes) {
        const double *x_of = x + own.at, *v_of = v + own.at;
        NodeRecord& to = record[own.node];
        to.x[0] = x_of[0], to.x[1] = x_of[y], to.x[2] = x_of[z];
        to.v[0] = v_of[0], to.v[1] = v_of[y], to.v[2] = v_of[z];
    }
}

void GoreNodes::scatter_add_contact(State& state, std::span<const OwnNode> nodes,
                                    std::vector<OnLine>& on_lines) const {
    const NodeForces::View force = state.force.view();
    on_lines.clear();
    for (const auto& [i, n, gore, at] : nodes) {
        const Lanes push = force[i].value;
        if (push[0] == 0.0 && push[1] == 0.0 && push[2] == 0.0) continue;
        force[i].value = splat(0.0);
        const bool on_line = n >= gores_.canopy;
        if (on_line) on_lines.push_back({n, gore, push});
        double* to = (on_line ? frame.aero : frame.force) + at;
        for (int c = 0; c < 3; ++c)
            to[c * frame.lanes] += push[c];
    }
}

void GoreNodes::scatter_add_forces(State& state) const {
    for (LocalNode n = 0; n < gores_.own; ++n)
        for (int gore = 0; gore < gores_.count; ++gore) {
            const auto i = static_cast<std::size_t>(gores_.node[gore * gores_.own + n]);
            for (int c = 0; c < 3; ++c) {
                at(frame.force, n, gore, c) += state.force[i].value[c];
                at(frame.aero, n, gore, c) += state.aero[i].value[c];
            }
            state.force[i].value = splat(0.0);
            state.aero[i].value = splat(0.0);
        }
}

const std::vector<std::size_t>& GoreNodes::places() const {
    if (!place_.empty()) return place_;
    for (LocalNode n = 0; n < gores_.canopy; ++n)
        for (int gore = 0; gore < gores_.count; ++gore) {
            const auto i = static_cast<std::size_t>(gores_.node[gore * gores_.own + n]);
            if (i >= place_.size()) place_.resize(i + 1);
            place_[i] = static_cast<std::size_t>(&at(frame.x, n, gore, 0) - frame.x);
        }
    return place_;
}

void GoreNodes::read(std::span<const NodeIndex> nodes, std::span<NodeRecord> to) const {
    const std::vector<std::size_t>& place = places();
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        to[k] = {splat(0.0), splat(0.0)};
        for (int c = 0; c < 3; ++c) {
            const std::size_t from = place[nodes[k]] + static_cast<std::size_t>(c * frame.lanes);
            to[k].x[c] = frame.x[from];
            to[k].v[c] = frame.v[from];
        }
    }
}

void GoreNodes::push(std::span<const NodeIndex> nodes, std::span<const Lanes> force) const {
    const std::vector<std::size_t>& place = places();
    for (std::size_t k = 0; k < nodes.size(); ++k)
        for (int c = 0; c < 3; ++c)
            frame.force[place[nodes[k]] + static_cast<std::size_t>(c * frame.lanes)] += force[k][c];
}

void GoreNodes::gather_shared(const State& state, int block) const {
    for (const Sharing& s : shared_[block]) {
        const NodeRecord& node = state.node[s.node];
        double *const x = &at(frame.x, s.local, s.first, 0), *const v = &at(frame.v, s.local, s.first, 0);
        for (int gore = 0; gore < s.last - s.first; ++gore)
            for (int c = 0; c < 3; ++c) {
                x[c * frame.lanes + gore] = node.x[c];
                v[c * frame.lanes + gore] = node.v[c];
            }
    }
}

void GoreNodes::reduce_shared(int block, std::span<double* const> arrays) const {
    for (std::size_t which = 0; which < arrays.size(); ++which) {
        double* to = of_shared(block, static_cast<int>(which));
        for (const Sharing& s : shared_[block]) {
            const double* on = &at(arrays[which], s.local, s.first, 0);
            for (int c = 0; c < 3; ++c, on += frame.lanes)
                *to++ = std::accumulate(on, on + (s.last - s.first), 0.0);
        }
        for (std::size_t k = 0; k < gores_.shared.size(); ++k)
            std::fill_n(arrays[which] + frame.at(block, first_shared() + static_cast<LocalNode>(k)),
                        3 * frame.lanes, 0.0);
    }
}

void GoreNodes::scatter_add_shared(int which, NodeForces& forces) const {
    const NodeForces::View on_node = forces.view();
    for (int block = 0; block < frame.blocks; ++block) {
        const double* from = of_shared(block, which);
        for (const Sharing& s : shared_[block])
            for (int c = 0; c < 3; ++c)
                on_node[s.node].value[c] += *from++;
    }
}

}  // namespace twinchute::fullsim
