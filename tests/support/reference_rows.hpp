// Rows of numbers of a file in data/reference.
#pragma once

#include <cctype>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace twinchute::test {

/// Lines that start with # or a letter are skipped.
inline std::vector<std::vector<double>> reference_rows(const std::string& name) {
    std::ifstream file(std::string(TWINCHUTE_SOURCE_DIR) + "/data/reference/" + name);
    std::vector<std::vector<double>> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0]))) continue;
        std::istringstream cells(line);
        rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');)
            rows.back().push_back(std::stod(cell));
    }
    return rows;
}

}  // namespace twinchute::test
