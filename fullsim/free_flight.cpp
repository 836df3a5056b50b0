#include "fullsim/free_flight.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "lib/scene/line_stretch.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double tolerance = 1e-10;  // relative, and of metres and metres per second

Vec3 vector_at(std::span<const double> y, std::size_t first) {
    return {y[first], y[first + 1], y[first + 2]};
}

}  // namespace

PayloadFlight released_payload(const Scene& scene) {
    double mass = scene.payload.mass;
    for (const Parachute& chute : scene.parachutes)
        mass += chute.count * chute.mass;
    const Vec3 position(0.0, 0.0, scene.release.altitude), velocity = velocity_over_ground(scene.release);
    return {0.0, position, velocity, mass, free_acceleration(scene, mass, position, velocity)};
}

Vec3 free_acceleration(const Scene& scene, double mass, const Vec3& position, const Vec3& velocity) {
    Vec3 acceleration = -scene.environment.gravity * Vec3::UnitZ();
    if (!scene.payload.drag_area) return acceleration;
    Vec3 airspeed = velocity;
    if (scene.environment.wind) airspeed -= scene.environment.wind->at(position.z());
    const double density = scene.environment.atmosphere.at(position.z()).density;
    return acceleration - 0.5 * density * *scene.payload.drag_area / mass * airspeed.norm() * airspeed;
}

PayloadFlight fly_free(const Scene& scene, const PayloadFlight& from, double end, const FlightWatch& watch) {
    std::array<double, 6> start{};
    for (int c = 0; c < 3; ++c) {
        start[static_cast<std::size_t>(c)] = from.position[c];
        start[static_cast<std::size_t>(c) + 3] = from.velocity[c];
    }
    const auto flight_at = [&](double t, std::span<const double> y) {
        const Vec3 position = vector_at(y, 0), velocity = vector_at(y, 3);
        return PayloadFlight{t, position, velocity, from.mass,
                             free_acceleration(scene, from.mass, position, velocity)};
    };
    OdeSolver solver(
        explicit_methods().front(),
        [&](double t, std::span<const double> y, std::span<double> rates) {
            const PayloadFlight now = flight_at(t, y);
            for (int c = 0; c < 3; ++c) {
                rates[static_cast<std::size_t>(c)] = now.velocity[c];
                rates[static_cast<std::size_t>(c) + 3] = now.acceleration[c];
            }
        },
        from.time, start, tolerance, std::vector<double>(start.size(), tolerance), 3);
    if (watch)
        solver.watch(static_cast<int>(watch(from).size()),
                     [&](double t, std::span<const double> y, std::span<double> values) {
                         std::ranges::copy(watch(flight_at(t, y)), values.begin());
                     });
    solver.stop_at(end);
    for (;;) {
        switch (solver.advance()) {
            case OdeSolver::Outcome::stepped:
                continue;
            case OdeSolver::Outcome::reached_stop:
            case OdeSolver::Outcome::found_root:
                return flight_at(solver.time(), solver.state());
            case OdeSolver::Outcome::failed:
                throw std::runtime_error(solver.failure());
        }
    }
}

}  // namespace twinchute::fullsim
