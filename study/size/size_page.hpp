// The report of a sizing: one page without scripts.
#pragma once

#include <stop_token>
#include <string>

#include "rom/size/size.hpp"

namespace twinchute::study {

/// Candidates, limits, what was assumed; shares of the limits around the values found, for which it runs the
/// model again; openings of the candidates above each other. Throws rom::Interrupted.
std::string size_page(const Scene& scene, const rom::Sized& sized, const std::stop_token& stop);

}  // namespace twinchute::study
