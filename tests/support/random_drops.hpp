// Random drops that could be flown: materials that bear their loads, masses that give a terminal speed,
// heights from which a steady descent can be reached. Each by its seed and number alone.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "lib/math/vec.hpp"
#include "tests/support/random.hpp"

namespace twinchute::test {

/// Materials of these drops: nylon as data/materials has it, in sizes that fabric and cord are made in.
struct DropMaterials {
    static constexpr std::array cord_mm{0.3, 0.5, 0.8, 1.2, 1.8, 2.5, 4.0, 6.0, 9.0, 13.0, 19.0, 28.0, 40.0};
    static constexpr std::array fabric_mm{0.03, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6};
    static constexpr double cord_density = 462.0, cord_modulus = 9.7e8;      // [kg/m^3], [Pa]
    static constexpr double fabric_density = 533.0, fabric_modulus = 4.3e8;  // [kg/m^3], [Pa]
};

/// Writes what scenes of random drops name, to lie beside them.
inline void write_drop_data(const std::filesystem::path& directory) {
    std::filesystem::create_directories(directory / "materials");
    using M = DropMaterials;
    for (const double d : M::cord_mm)
        std::ofstream(directory / "materials" / fmt::format("cord-{:g}mm.toml", d))
            << fmt::format("kind = \"cord\"\ndensity = {}\nyoungs_modulus = {}\ndiameter = \"{:g} mm\"\n",
                           M::cord_density, M::cord_modulus, d);
    for (const double t : M::fabric_mm)
        std::ofstream(directory / "materials" / fmt::format("fabric-{:g}mm.toml", t)) << fmt::format(
            "kind = \"fabric\"\ndensity = {}\nyoungs_modulus = {}\npoisson_ratio = 0.3\n"
            "thickness = \"{:g} mm\"\n",
            M::fabric_density, M::fabric_modulus, t);
    std::ofstream(directory / "drop-wind.csv")
        << "altitude,speed,from\nm,m/s,deg\n0,3,250\n1000,8,270\n5000,20,280\n12000,35,285\n";
}

struct RandomDrop {
    std::string text;             ///< of the scene file
    std::string kind;             ///< a few words: how it starts, what is special
    double terminal_speed = 0.0;  ///< [m/s] of drag area and mass, in the air at the release
    bool too_low = false;         ///< released so low that no steady descent is to be expected
    double swing = 0.0;           ///< [s] period of the pendulum of payload and canopy
};

/// One drop of the set that `seed` names. `full`: only what the full model has, and its settings; otherwise
/// what the reduced-order model has.
class DropGenerator : Random {
public:
    DropGenerator(std::uint64_t seed, int number, bool full)
        : Random(seed * 1'000'003 + 2 * static_cast<std::uint64_t>(number) + (full ? 1 : 0)),
          seed_(seed),
          number_(number),
          full_(full) {
        for (int i = 0; i < 8; ++i)
            bits();
    }

    RandomDrop drop();

private:
    double log_in(double low, double high) { return low * std::pow(high / low, share()); }
    double in(double low, double high) { return low + (high - low) * share(); }
    /// A thousandth is enough for a scene, and better to read.
    static std::string text_of(double value) { return fmt::format("{:.4g}", value); }
    template <class... Values>
    void line(fmt::format_string<Values...> format, Values&&... values) {
        out_.text += fmt::format(format, std::forward<Values>(values)...) + "\n";
    }

    void choose_flight();
    void choose_canopy();
    void size_materials();
    double opening_force() const;
    void put_environment();
    void put_release();
    void put_canopy(double scale);
    void put_deployment();
    void put_opening();
    void put_drogue();
    void put_aerodynamics();
    void put_full();

    static constexpr double g = 9.80665;
    const std::uint64_t seed_;
    const int number_;
    const bool full_;
    RandomDrop out_;

    std::string by_;
    bool packed_ = false, fixed_end_ = false, drogue_ = false, given_time_ = false;
    double angle_ = 0.0;  // [rad] below the horizon
    double speed_ = 0.0;  // [m/s] at release
    double diameter_ = 0.0, drag_coefficient_ = 0.0, projected_ = 0.0, n_ = 0.0;
    int gores_ = 0, risers_ = 1, count_ = 1;
    double line_ = 0.0, riser_ = 0.0;   // [m]
    double ratio_ = 0.0;                // drag area at snatch over the steady one
    double cord_ = 0.0, fabric_ = 0.0;  // [mm]
    double chute_mass_ = 0.0, payload_mass_ = 0.0;
    double density_ = 0.0;  // [kg/m^3] at release; of constant air
    double ground_ = 0.0, height_ = 0.0;
    std::string air_, wind_;

    double area() const { return 0.25 * pi * diameter_ * diameter_; }
    double drag_area() const { return drag_coefficient_ * area() * count_; }
};

inline void DropGenerator::choose_flight() {
    const double r = share();
    if (full_)
        by_ = r < 0.36   ? "line-stretch"
              : r < 0.46 ? "inflated"
              : r < 0.62 ? "free"
              : r < 0.78 ? "extraction"
                         : "static-line";
    else
        by_ = r < 0.26   ? "line-stretch"
              : r < 0.34 ? "inflated"
              : r < 0.46 ? "free"
              : r < 0.58 ? "extraction"
              : r < 0.72 ? "static-line"
              : r < 0.86 ? "pilot"
                         : "mortar";
    packed_ = by_ != "line-stretch" && by_ != "inflated";
    fixed_end_ = by_ == "static-line" && random_bool(0.35);
    const double way = share();
    angle_ = way < 0.25 ? 0.5 * pi : way < 0.45 ? 0.0 : way < 0.8 ? in(0.15, 1.4) : -in(0.15, 1.45);
    speed_ = log_in(2.0, 150.0);
    // Drawn out by the air alone, a parachute needs some.
    if (by_ == "free") speed_ = log_in(15.0, 150.0);
    if (fixed_end_) speed_ = random_bool(0.5) ? 0.0 : log_in(2.0, 12.0);
    if (by_ == "static-line" && !fixed_end_) angle_ = in(-0.1, 0.1);
    out_.terminal_speed = log_in(2.0, 60.0);
    // An open canopy at many times its speed would not have stayed whole.
    if (by_ == "inflated") speed_ = std::min(speed_, 3.0 * out_.terminal_speed);
}

inline void DropGenerator::choose_canopy() {
    diameter_ = log_in(0.3, 40.0);
    drag_coefficient_ = in(0.55, 0.9);
    projected_ = in(0.6, 0.72);
    gores_ = diameter_ < 1.5   ? one_of(std::array{6, 8})
             : diameter_ < 8.0 ? one_of(std::array{8, 10, 12})
                               : one_of(std::array{10, 12, 16});
    risers_ = gores_ % 4 == 0 ? one_of(std::array{1, 2, 4}) : one_of(std::array{1, 2});
    line_ = diameter_ * in(0.8, 1.3);
    riser_ = diameter_ * in(0.05, 0.25);
    n_ = log_in(1.5, 14.0);
    ratio_ = log_in(0.005, 0.15);
    if (!full_ && by_ != "inflated" && random_bool(0.2)) count_ = 2 + static_cast<int>(below(3));
}

/// [N] largest drag in an opening that takes n diameters, from the release's speed or the terminal one.
inline double DropGenerator::opening_force() const {
    const double mass = payload_mass_ + count_ * chute_mass_,
                 fastest = std::max(speed_, 1.2 * out_.terminal_speed);
    const double full = by_ == "inflated" ? 0.0 : n_ * diameter_ / fastest;
    double v = fastest, largest = 0.0;
    if (full == 0.0) return 0.5 * density_ * v * v * drag_area();
    const int steps = 400;
    for (int i = 0; i < 2 * steps; ++i) {
        const double share = std::min(1.0, static_cast<double>(i) / steps);
        const double grown = ratio_ + (1.0 - ratio_) * share * share;
        const double drag = 0.5 * density_ * v * v * drag_area() * grown;
        largest = std::max(largest, drag);
        v = std::max(0.0, v + (g - drag / mass) * full / steps);
    }
    return largest;
}

/// Lines strained by 8 % at most, fabric by 5 %, at 1.5 times the opening force, and lines by 15 % at snatch;
/// then the masses.
inline void DropGenerator::size_materials() {
    using M = DropMaterials;
    const auto least = [](const auto& sizes, double size) {
        for (const double s : sizes)
            if (s >= size) return s;
        return sizes.back();
    };
    const double terminal_mass = 0.5 * density_ * out_.terminal_speed * out_.terminal_speed * drag_area() / g;
    payload_mass_ = terminal_mass;
    chute_mass_ = 0.0;
    const double length = line_ + riser_;
    for (int i = 0; i < 3; ++i) {
        const double force = 1.5 * std::max(opening_force(), 3.0 * g * payload_mass_) / count_;
        const double mouth = 0.25 * pi * std::pow(projected_ * diameter_, 2);
        const double tension = force / mouth * 0.25 * projected_ * diameter_;  // [N/m] of a sphere
        fabric_ = least(M::fabric_mm, 1e3 * tension / (0.05 * M::fabric_modulus));
        const double fabric = area() * 1e-3 * fabric_ * M::fabric_density;
        const double parting = 0.5 * speed_ + std::sqrt(2.0 * g * length);
        const double stiffness =  // [N] E A of all lines
            std::max(force / 0.08, packed_ ? fabric * parting * parting / (0.15 * 0.15 * length) : 0.0);
        cord_ = least(M::cord_mm, 1e3 * std::sqrt(4.0 * stiffness / (gores_ * M::cord_modulus * pi)));
        const double per_metre = 0.25 * pi * 1e-6 * cord_ * cord_ * M::cord_density;
        const double tapes = gores_ * 0.5 * diameter_ + 1.1 * pi * diameter_;
        chute_mass_ = fabric + per_metre * (gores_ * line_ + risers_ * riser_ + tapes);
        payload_mass_ = std::max(terminal_mass - count_ * chute_mass_, 2.0 * count_ * chute_mass_);
    }
    out_.terminal_speed =
        std::sqrt(2.0 * g * (payload_mass_ + count_ * chute_mass_) / (density_ * drag_area()));
}

inline void DropGenerator::put_environment() {
    line("[environment]");
    line("{}", air_);
    if (ground_ > 0.0) line("ground = {}", text_of(ground_));
    if (!wind_.empty()) line("{}", wind_);
}

inline void DropGenerator::put_release() {
    line("\n[payload]\nmass = {}", text_of(payload_mass_));
    if (random_bool(0.3)) line("drag_area = {}", text_of(in(0.01, 0.06) * drag_area()));
    if (full_ && random_bool(0.08)) {
        // So slim that risers of any number reach over it.
        const double across = std::min(0.5 * riser_, std::cbrt(payload_mass_ / 400.0));
        const double tall = std::clamp(payload_mass_ / (400.0 * across * across), across, 4.0 * across);
        const bool box = random_bool(0.5) && risers_ == 4;
        out_.kind += box ? ", box" : ", cylinder";
        if (box)
            line("body = {{ shape = \"box\", size = [{}, {}, {}] }}", text_of(across), text_of(across),
                 text_of(tall));
        else
            line("body = {{ shape = \"cylinder\", size = [{}, {}] }}", text_of(across), text_of(tall));
    }
    line("\n[release]\nheight = {}\nspeed = {}", text_of(height_), text_of(speed_));
    if (speed_ > 0.0) line("path_angle = {}", angle_ == 0.5 * pi ? "\"90 deg\"" : text_of(angle_));
}

/// The canopy of the drop, or one `scale` times as large.
inline void DropGenerator::put_canopy(double scale) {
    line("nominal_diameter = {}\ndrag_coefficient = {}\nprojected_diameter_ratio = {}\nmass = {}",
         text_of(scale * diameter_), text_of(drag_coefficient_), text_of(projected_),
         text_of(scale * scale * chute_mass_));
    line("gores = {}\nrisers = {}\nvent_diameter = {}\nline_length = {}\nriser_length = {}", gores_, risers_,
         text_of(0.1 * scale * diameter_), text_of(scale * line_), text_of(scale * riser_));
    line("fabric = \"fabric-{:g}mm\"\nline = \"cord-{:g}mm\"", fabric_, cord_);
    line("tapes = {{ radial = \"cord-{:g}mm\", skirt = \"cord-{:g}mm\", vent = \"cord-{:g}mm\" }}", cord_,
         cord_, cord_);
}

inline void DropGenerator::put_deployment() {
    std::string keys;
    const auto key = [&](std::string_view name, double value) {
        keys += fmt::format(", {} = {}", name, text_of(value));
    };
    const double length = line_ + riser_ + 0.5 * diameter_;
    if (by_ == "static-line") {
        key("length", in(0.3, 1.3) * length);
        if (fixed_end_) keys += ", anchor = \"fixed\"";
    }
    if (by_ == "extraction") {
        const double parting = log_in(8.0, 70.0);
        key("force", count_ * chute_mass_ * (0.5 * parting * parting / length + 2.0 * g));
        if (full_ && random_bool(0.4)) keys += ", load = \"distributed\"";
    }
    if (by_ == "pilot") key("pilot_drag_area", in(0.005, 0.03) * drag_area());
    if (by_ == "mortar") key("muzzle_speed", in(15.0, 50.0));
    if (by_ == "free" || by_ == "extraction" || (!full_ && packed_ && by_ != "pilot" && random_bool(0.5)))
        key("pack_drag_area", in(0.002, 0.02) * drag_area());
    // Fabric is stowed the more firmly the heavier it is: the C-9's 2 N/m, by its weight and size.
    if (full_ && packed_) key("deployment_resistance", 2.0 * diameter_ / 8.53 * fabric_ / 0.1);
    if (full_ && packed_ && random_bool(0.2)) key("pitch", in(-0.3, 0.3));
    if (drogue_)
        keys += random_bool(0.5) ? fmt::format(", when = {{ after = \"drogue.full-open\", delay = {} }}",
                                               text_of(in(0.5, 5.0)))
                                 : fmt::format(", when = {{ height = {} }}", text_of(in(0.5, 0.9) * height_));
    line("deploy = {{ by = \"{}\"{} }}", by_, keys);
}

inline void DropGenerator::put_opening() {
    const double model = share();
    given_time_ = model > 0.85 && speed_ > 0.0;
    if (given_time_)
        line("fill_time.time = {}\ninitial_phase = 0",
             text_of(n_ * diameter_ / std::max(speed_, 0.5 * out_.terminal_speed)));
    else if (!full_ && model > 0.7)
        line("fill_time = {{ model = \"knacke-0.85\", n = {} }}", text_of(n_));
    else
        line("fill_time.n = {}", text_of(n_));
    if (!given_time_ && random_bool(0.25)) line("initial_phase = 0");
    const double law = share();
    line("drag_area_law = \"{}\"", law < 0.6    ? "ludtke"
                                   : law < 0.75 ? "power-1"
                                   : law < 0.9  ? "power-2"
                                                : "power-3");
    line("initial_drag_area_ratio = {}", text_of(ratio_));
    if (by_ == "inflated" || !random_bool(0.18)) return;
    out_.kind += ", reefed";
    double stage = std::max(1.5 * ratio_, log_in(0.03, 0.3)), until = 0.0;
    const double filling = n_ * diameter_ / std::max(speed_, out_.terminal_speed);
    for (std::size_t i = 1 + below(2); i > 0; --i) {
        until += std::max(0.3, log_in(0.5, 3.0) * filling);
        line("\n[[parachute.reefing]]\ndrag_area_ratio = {}\nuntil = {{ at = \"line-stretch\", delay = {} }}",
             text_of(std::min(stage, 0.9)), text_of(until));
        stage *= in(1.5, 2.5);
        if (stage > 0.85) break;
    }
}

/// A drogue on the same lines, which slows the payload before its main parachute opens.
inline void DropGenerator::put_drogue() {
    const double scale = in(0.12, 0.3);
    line("\n[[parachute]]\nname = \"drogue\"");
    put_canopy(scale);
    const bool late = angle_ < 0.0 && random_bool(0.6);
    line("deploy = {{ by = \"line-stretch\"{} }}", late ? ", when = { at = \"apogee\", delay = 1 }" : "");
    line("fill_time.n = {}\ninitial_drag_area_ratio = {}", text_of(log_in(1.5, 8.0)), text_of(ratio_));
    if (random_bool(0.7))
        line("cut = {{ after = \"main.line-stretch\", delay = {} }}", text_of(in(0.0, 0.5)));
}

inline void DropGenerator::put_aerodynamics() {
    line("\n[aerodynamics]");
    const double air = share();
    if (air < 0.85)
        line("added_mass = {{ model = \"{}\", momentum = \"{}\" }}",
             air < 0.6 ? "hemisphere" : "half-ellipsoid", random_bool(0.2) ? "accreting" : "inertia-only");
    if (!full_) return;
    if (random_bool(0.7)) line("line_drag = {{ model = \"cylinder\" }}");
    if (random_bool(0.85)) line("breathing_damping = {{ k = {} }}", text_of(log_in(0.2, 2.0)));
}

/// The coarsest meshes that are still a canopy. Coarser ones pass through themselves on their way out of the
/// pack, and one in seven (one element across) or in eighteen (two, in four rows) stays wound twice around
/// its axis.
inline void DropGenerator::put_full() {
    line("\n[full]");
    const auto line_elements = 2 + below(2), rows = 3 + below(2);
    const bool fine = random_bool(0.2);
    line("mesh = {{ gore_columns = {}, gore_rows = {}, line_elements = {}, riser_elements = 1 }}",
         fine || packed_ ? 2 : 1, packed_ ? 2 * rows : rows, line_elements);
    const bool noise = packed_ || random_bool(0.4);
    if (noise) {
        const auto seed = 1 + below(1000);
        line("noise = {{ amplitude = {}, seed = {} }}", text_of(diameter_ / 8.53 * log_in(1e-5, 3e-4)), seed);
    }
    if (random_bool(0.3)) line("alpha = {}", text_of(log_in(0.5, 10.0)));
    if (packed_ && random_bool(0.4)) {
        line("structure = \"fe\"");
        out_.kind += ", fe";
    }
    const bool straight = angle_ == 0.5 * pi && wind_.empty() && out_.text.find("body") == std::string::npos;
    if (!packed_ && !noise && straight && random_bool(0.4)) {
        line("symmetry = \"sector\"");
        out_.kind += ", sector";
    }
    if (!packed_ && random_bool(0.5)) {
        line("contact = \"gores\"");
        out_.kind += ", contact";
    }
    line("output_rate = 100");
}

inline RandomDrop DropGenerator::drop() {
    choose_flight();
    choose_canopy();
    const double air = share();
    if (air < 0.35) {
        density_ = in(0.4, 1.25);
        air_ = fmt::format("atmosphere = {{ density = {} }}", text_of(density_));
    } else {
        ground_ = random_bool(0.3) ? in(100.0, 3000.0) : 0.0;
        const double offset = air > 0.8 ? in(-25.0, 25.0) : 0.0;
        air_ = offset == 0.0 ? "atmosphere = \"us76\""
                             : fmt::format("atmosphere = {{ temperature_offset = {} }}", text_of(offset));
        density_ = 1.225 * std::exp(-ground_ / 9000.0);
    }
    const double blows = share();
    if (blows > 0.9) wind_ = "wind = { table = \"drop-wind.csv\" }";
    if (blows > 0.65 && blows <= 0.9) {
        const double from = in(0.0, 6.2);
        wind_ = fmt::format("wind = {{ speed = {}, from = {} }}", text_of(log_in(1.0, 15.0)), text_of(from));
    }

    // Twice: the density at the release hangs on the height, and that on the terminal speed.
    const double length = line_ + riser_ + 0.4 * diameter_;
    out_.swing = 2.0 * pi * std::sqrt(length / g);
    const double settling = 15.0 + 6.0 * out_.swing;
    const double wanted = out_.terminal_speed;
    for (int i = 0; i < 2; ++i) {
        out_.terminal_speed = wanted;
        size_materials();
        const double v = out_.terminal_speed, rises = angle_ < 0.0 ? speed_ * speed_ / (2.0 * g) : 0.0;
        height_ = 4.0 * length + 2.0 * n_ * diameter_ + 5.0 * std::max(speed_, v) + 0.5 * rises +
                  v * (settling + 10.0 * v / g + 65.0);
        if (air >= 0.35) density_ = 1.225 * std::exp(-(ground_ + height_) / 9000.0);
    }
    out_.too_low = random_bool(0.06);
    if (out_.too_low) height_ = length + in(0.03, 0.25) * height_;

    drogue_ = !full_ && random_bool(0.12) && by_ != "inflated" && by_ != "static-line";
    out_.kind = by_ + (fixed_end_ ? " fixed" : "") +
                (angle_ == 0.5 * pi ? " down"
                 : angle_ == 0.0    ? " level"
                 : angle_ < 0.0     ? " up"
                                    : " oblique");
    if (!wind_.empty()) out_.kind += ", wind";
    if (count_ > 1) out_.kind += fmt::format(", {} of them", count_);
    if (drogue_) out_.kind += ", drogue";
    if (out_.too_low) out_.kind += ", low";
    line("schema = 1\nname = \"drop {} of {}\"\n", number_, seed_);
    put_environment();
    put_release();
    if (drogue_) put_drogue();
    line("\n[[parachute]]\nname = \"main\"");
    put_canopy(1.0);
    if (count_ > 1) {
        line("count = {}", count_);
        if (by_ != "inflated" && random_bool(0.4)) {
            std::string lags;
            for (int i = 0; i < count_; ++i)
                lags += fmt::format("{}{}", i ? ", " : "", text_of(i ? in(0.0, 1.0) : 0.0));
            line("lag = [{}]", lags);
        }
        if (random_bool(0.5)) line("cluster_drag_ratio = {}", text_of(in(0.85, 1.0)));
    }
    put_deployment();
    put_opening();
    put_aerodynamics();
    if (full_) put_full();
    if (random_bool(0.1)) line("\n[stop]\nat = \"steady-descent\"\ndelay = {}", text_of(in(0.5, 5.0)));
    return out_;
}

}  // namespace twinchute::test
