// Cells that the terminal and Markdown have in common.
#pragma once

#include <string>

#include "compare/validate/report.hpp"

namespace twinchute::compare {

/// "case, quantity", where it has one.
std::string row_title(const RowResult& row);
std::string expected_text(const RowResult& row);
std::string predicted_text(const RowResult& row);  ///< with its range, where it has one
std::string error_text(const RowResult& row);
std::string tolerance_text(const RowResult& row);
std::string verdict_text(const ShownRow& shown);
std::string quantity_text(const ShownRow& shown);  ///< with its unit

/// Every row that was run.
Table suite_table(const std::vector<ShownRow>& shown);

}  // namespace twinchute::compare
