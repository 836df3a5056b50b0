// Names of suites, and where they lie.
#include "compare/validate/suite.hpp"

#include <fmt/format.h>

#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute::compare {

std::string_view evidence_name(Evidence evidence) {
    switch (evidence) {
        case Evidence::exact:
            return "exact";
        case Evidence::printed:
            return "printed";
        case Evidence::measured:
            return "measured";
        case Evidence::synthetic:
            return "synthetic";
    }
    return "unknown";
}

std::string_view agreement_word(Evidence evidence) {
    switch (evidence) {
        case Evidence::exact:
            return "verified";
        case Evidence::printed:
            return "reproduced";
        case Evidence::measured:
            return "validated";
        case Evidence::synthetic:
            return "met";
    }
    return "unknown";
}

std::vector<std::string> suite_names() {
    std::vector<std::string> names = data_names("validation");
    std::erase_if(names, [](const std::string& name) { return name.find('/') != std::string::npos; });
    return names;
}

std::filesystem::path suite_file(const std::string& name) {
    if (const auto file = find_data_file("validation", name, {})) return *file;
    const std::vector<std::string> names = suite_names();
    throw SceneError({}, "--suite", fmt::format("there is no suite '{}'", name), "",
                     suggest(name, {names.begin(), names.end()}));
}

}  // namespace twinchute::compare
