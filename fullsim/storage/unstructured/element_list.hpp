// Elements of the unstructured layout in groups of SIMD lanes: node offsets and constants.
#pragma once

#include <array>
#include <vector>

#include "fullsim/state.hpp"
#include "fullsim/storage/unstructured/kernels.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim::unstructured {

/// Elements, or sets of two that share corners, one after the other, as the kernels want them in groups.
class ElementList {
public:
    /// lanes: elements of a group. members: elements of a set. padding: constants of an element
    /// without effect.
    template <std::size_t corners, std::size_t members = 1, std::size_t constants>
    void begin(std::size_t count, int lanes, NodeIndex dummy, const std::array<double, constants>& padding) {
        lanes_ = static_cast<std::size_t>(lanes), width_ = lanes_ / members;
        corners_ = corners, constants_ = constants;
        groups_ = (count + width_ - 1) / width_;
        node_.assign(groups_ * corners * width_, row_offset(dummy));
        node_.shrink_to_fit();
        constant_.assign((groups_ * constants * lanes_ + Line{}.size() - 1) / Line{}.size(), Line{});
        constant_.shrink_to_fit();
        for (std::size_t i = count; i < groups_ * width_; ++i)
            for (std::size_t k = 0; k < members; ++k)
                set_constants(i / width_, k * width_ + i % width_, padding);
    }

    /// Corners and constants, where members share corners those of one after those of the other.
    template <std::size_t corners, std::size_t constants, std::size_t members>
    void set(std::size_t i, const std::array<NodeIndex, corners>& node,
             const std::array<std::array<double, constants>, members>& constant) {
        const std::size_t group = i / width_, lane = i % width_;
        for (std::size_t c = 0; c < corners; ++c)
            node_[(group * corners_ + c) * width_ + lane] = row_offset(node[c]);
        for (std::size_t k = 0; k < members; ++k)
            set_constants(group, k * width_ + lane, constant[k]);
    }

    template <std::size_t corners, std::size_t constants>
    void set(std::size_t i, const std::array<NodeIndex, corners>& node,
             const std::array<double, constants>& constant) {
        set<corners, constants, 1>(i, node, {constant});
    }

    std::size_t bytes() const { return bytes_of(node_) + bytes_of(constant_); }

    Elements elements() const {
        return {groups_, node_.data(), constant_.empty() ? nullptr : constant_.front().data()};
    }

private:
    struct alignas(64) Line : std::array<double, 8> {};  // of a cache

    static std::int32_t row_offset(NodeIndex node) {
        return node * static_cast<std::int32_t>(sizeof(NodeVector));
    }

    template <std::size_t constants>
    void set_constants(std::size_t group, std::size_t lane, const std::array<double, constants>& constant) {
        for (std::size_t c = 0; c < constants; ++c) {
            const std::size_t at = (group * constants_ + c) * lanes_ + lane;
            constant_[at / Line{}.size()][at % Line{}.size()] = constant[c];
        }
    }

    std::size_t groups_ = 0, lanes_ = 1, width_ = 1, corners_ = 0, constants_ = 0;
    std::vector<std::int32_t> node_;
    std::vector<Line> constant_;
};

}  // namespace twinchute::fullsim::unstructured
