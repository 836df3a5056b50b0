// Texts with their own checksum: an edited one is not read.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lib/record/checksum.hpp"
#include "lib/record/read_record.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/record_json.hpp"
#include "tests/support/compare_records.hpp"

namespace twinchute {
namespace {

/// printf '{\n  "a": 1,\n  "sha256": ""\n}\n' | sha256sum
const std::string digits = "cf9f29d52da39a93f9c1215ef4f8f9b30e7cf4b3fb5aa9121094470d16722647";

TEST(RecordChecksum, IsThatOfTheTextWithoutItsDigits) {
    EXPECT_EQ(with_checksum("{\n  \"a\": 1\n}\n"), "{\n  \"a\": 1,\n  \"sha256\": \"" + digits + "\"\n}\n");
}

/// Complaint of a reader about the summary of a record.
std::string complaint(const std::string& summary) {
    const RunRecord record = compare::synthetic_record("rom", 4800, 1.45, 4e-4);
    try {
        read_record_text(summary, history_csv(record), events_csv(record), "d");
    } catch (const RecordError& error) {
        return error.what();
    }
    return "no complaint";
}

TEST(RecordChecksum, EveryEditOfASummaryIsNoticed) {
    const std::string whole =
        with_checksum(summary_json(compare::synthetic_record("rom", 4800, 1.45, 4e-4), {{"x.csv", digits}}));
    EXPECT_EQ(complaint(whole), "no complaint");
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = whole;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, text.npos) << from;
        return complaint(text.replace(at, from.size(), to));
    };
    const std::string edited =
        "d/summary.json: is not the file that was written (its SHA-256 without the digits under \"sha256\" "
        "is "
        "not these digits: it was edited), run the scene again";
    EXPECT_EQ(with("4800", "4801"), edited);                       // a metric
    EXPECT_EQ(with(digits, digits.substr(1) + "0"), edited);       // the sum of another file
    EXPECT_EQ(with("\n  \"inputs\"", "\n \"inputs\""), edited);    // a blank
    EXPECT_EQ(with("\"sha256\": \"", "\"sha256\": \"0"), edited);  // the first is the scene's
    EXPECT_EQ(complaint(whole + " "), edited);
    std::string other = whole;
    other[whole.size() - 5] = other[whole.size() - 5] == '0' ? '1' : '0';
    EXPECT_EQ(complaint(other), edited);  // its own last digit
    EXPECT_EQ(
        complaint(with_checksum(whole.substr(0, 2) + "\"sha256\": \"\",\n" + whole.substr(2))).substr(0, 43),
        "d/summary.json: the key 'sha256' stands twi");
}

TEST(RecordChecksum, WhatIsWrongIsSaidFirst) {
    std::string text = with_checksum(summary_json(compare::synthetic_record("rom", 4800, 1.45, 4e-4)));
    const std::size_t at = text.find("\"schema\": 1");
    EXPECT_NE(complaint(text.replace(at, 11, "\"schema\": 9")).find("schema: 9 is not known"), text.npos);
}

TEST(RecordChecksum, ARecordOfAnEarlierVersionHasNone) {
    const std::string text = summary_json(compare::synthetic_record("rom", 4800, 1.45, 4e-4));
    EXPECT_FALSE(nlohmann::json::parse(text).contains("sha256"));
    EXPECT_EQ(complaint(text), "no complaint");
}

}  // namespace
}  // namespace twinchute
