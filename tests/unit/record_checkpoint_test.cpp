// The file of a checkpoint: what is written is read to the same bits, anything else is refused with a reason.
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "lib/math/sha256.hpp"
#include "lib/record/checkpoint.hpp"
#include "lib/record/keeper.hpp"
#include "tests/support/chance.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

/// Parts of every kind, by chance.
struct Parts {
    double number = 0.0;
    std::optional<double> maybe;
    std::vector<double> numbers;
    std::int64_t whole = 0;
    bool flag = false;
    std::string text;
    std::vector<std::uint16_t> small;
    struct Row {
        double a, b;
    };
    std::vector<Row> rows;

    void keep(Keeper& k) {
        k.number("number", number);
        k.number("maybe", maybe);
        k.numbers("numbers", numbers);
        k.whole("whole", whole);
        k.flag("flag", flag);
        k.text("text", text);
        k.small("small", small);
        k.rows("rows", rows, [](Row& row, auto&& each) { each(row.a), each(row.b); });
    }
};

/// Any 64 bits: NaNs with a payload, infinities, subnormals, zeros with a sign.
double any_bits(test::Chance& chance) {
    return std::bit_cast<double>(chance.bits());
}

TEST(Keeper, ReadsTheBitsThatItWrote) {
    test::Chance chance(20261122);
    for (int round = 0; round < 500; ++round) {
        Parts parts;
        parts.number = round == 0 ? -0.0 : any_bits(chance);
        if (chance.bits() & 1) parts.maybe = any_bits(chance);
        for (std::size_t i = chance.bits() % 20; i > 0; --i) {
            parts.numbers.push_back(any_bits(chance));
            parts.text += static_cast<char>(chance.bits());
            parts.small.push_back(static_cast<std::uint16_t>(chance.bits()));
            parts.rows.push_back({any_bits(chance), any_bits(chance)});
        }
        parts.whole = static_cast<std::int64_t>(chance.bits());
        parts.flag = chance.bits() & 1;
        Keeper writer;
        parts.keep(writer);
        const std::string bytes = writer.take();
        Keeper reader(bytes, "a test");
        Parts again;
        again.keep(reader);
        reader.end();
        Keeper writer_again;
        again.keep(writer_again);
        ASSERT_EQ(writer_again.take(), bytes);
        ASSERT_EQ(std::bit_cast<std::uint64_t>(again.number), std::bit_cast<std::uint64_t>(parts.number));
        ASSERT_EQ(again.maybe.has_value(), parts.maybe.has_value());
        ASSERT_EQ(again.whole, parts.whole);
        ASSERT_EQ(again.text, parts.text);
        ASSERT_EQ(again.small, parts.small);
        ASSERT_EQ(again.rows.size(), parts.rows.size());
    }
}

TEST(Keeper, WritesWhatItsCommentSays) {
    Keeper k;
    double one = 1.0;
    k.number("x", one);
    // Kind, length of the name, name, how many (8 bytes, low ones first), and 1.0 as IEEE 754 has it.
    EXPECT_EQ(k.take(), std::string("d\1x\1\0\0\0\0\0\0\0\0\0\0\0\0\0\xF0\x3F", 19));
}

TEST(Keeper, RefusesWhatIsNotAskedFor) {
    Keeper writer;
    std::vector<double> three{1.0, 2.0, 3.0};
    int seven = 7;
    writer.numbers("three", three);
    writer.whole("seven", seven);
    const std::string bytes = writer.take();
    const auto refusal = [&](auto&& read, std::string_view of) {
        try {
            Keeper k(of, "d/checkpoint.bin");
            read(k);
            k.end();
        } catch (const RecordError& error) {
            EXPECT_EQ(error.place().file, "d/checkpoint.bin");
            return std::string(error.what());
        }
        return std::string();
    };
    const auto read_both = [&](Keeper& k) {
        std::vector<double> numbers;
        int whole = 0;
        k.numbers("three", numbers);
        k.whole("seven", whole, 0, 10);
    };
    EXPECT_EQ(refusal(read_both, bytes), "");
    for (std::size_t cut = 0; cut < bytes.size(); ++cut)
        EXPECT_NE(refusal(read_both, std::string_view(bytes).substr(0, cut)).find("ends too early"),
                  std::string::npos)
            << cut;
    EXPECT_NE(refusal(read_both, bytes + "d").find("something is left over"), std::string::npos);
    const auto other = [&](auto&& read) { return refusal(read, bytes); };
    EXPECT_NE(other([](Keeper& k) {
                  std::vector<double> numbers;
                  k.numbers("four", numbers);
              }).find("'four' should come"),
              std::string::npos);
    EXPECT_NE(other([](Keeper& k) {
                  std::vector<double> numbers(4);
                  k.numbers("three", std::span(numbers));
              }).find("'three' is of another length"),
              std::string::npos);
    EXPECT_NE(other([](Keeper& k) {
                  std::vector<double> numbers;
                  int whole = 0;
                  k.numbers("three", numbers);
                  k.whole("seven", whole, 0, 6);
              }).find("'seven' is out of range"),
              std::string::npos);
    EXPECT_NE(
        other([](Keeper& k) { k.same("three", "x", "is of another mesh"); }).find("'three' should come"),
        std::string::npos);
    // A number of parts that no file could hold asks for no memory.
    std::string huge("d\5three", 7);
    huge += std::string(8, '\xFF');
    EXPECT_NE(refusal(read_both, huge).find("ends too early"), std::string::npos);
}

Checkpoint synthetic() {
    return {{"1.0 (abc), GNU, -O3", "full", "digest"},
            {{0.5, "fields/frame-000000.vtu", ".frame-000000.vtu.1-0.tmp", "sum"}},
            std::string("state\0with a zero", 17)};
}

TEST(Checkpoint, IsReadAsItWasWritten) {
    const Checkpoint checkpoint = synthetic();
    EXPECT_EQ(read_checkpoint_bytes(checkpoint_bytes(checkpoint), "f"), checkpoint);
}

TEST(Checkpoint, IsRefusedWithAnyByteChangedOrCutOff) {
    const std::string bytes = checkpoint_bytes(synthetic());
    const auto why_not = [](const std::string& text) {
        try {
            read_checkpoint_bytes(text, "f");
        } catch (const RecordError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(why_not(bytes), "");
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ 0x10);
        ASSERT_NE(why_not(changed), "") << "byte " << i;
        ASSERT_NE(why_not(bytes.substr(0, i)), "") << "cut at " << i;
    }
    EXPECT_NE(why_not(bytes + "\n"), "");
    EXPECT_NE(why_not("").find("is no checkpoint of this version"), std::string::npos);
    EXPECT_NE(why_not("{}").find("is no checkpoint of this version"), std::string::npos);
    // A format of a later version has another number.
    std::string later = bytes;
    later[later.find('\n') - 1] = '2';
    EXPECT_NE(why_not(later).find("is no checkpoint of this version"), std::string::npos);
    // What was put together by hand, with a sum that fits, is held to its parts.
    const std::string head =
        bytes.substr(0, bytes.find('\n') + 1) + std::string("t\5other\0\0\0\0\0\0\0\0", 15);
    EXPECT_NE(why_not(head + sha256_hex(head)).find("does not hold what this version keeps"),
              std::string::npos);
}

TEST(Checkpoint, OfAnotherRunIsRefusedByWhatDiffers) {
    const CheckpointOf wanted = synthetic().of;
    require_same(wanted, wanted, "f");
    const auto why_not = [&](const CheckpointOf& found) {
        try {
            require_same(found, wanted, "d/checkpoint.bin");
        } catch (const RecordError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CheckpointOf found = wanted;
    found.program = "0.9";
    EXPECT_EQ(
        why_not(found),
        "d/checkpoint.bin: is of another version of this program (written by 0.9, this is 1.0 (abc), GNU, "
        "-O3), run without --resume to begin from release");
    found = wanted;
    found.fidelity = "rom";
    EXPECT_NE(why_not(found).find("is of another model"), std::string::npos);
    found = wanted;
    found.scene = "other";
    EXPECT_NE(why_not(found).find("is of another scene"), std::string::npos);
}

TEST(Checkpoint, IsKnownByItsBeginning) {
    const ScratchDir here;
    EXPECT_EQ(read_checkpoint(here.path()), std::nullopt);
    here.write("checkpoint.bin", checkpoint_bytes(synthetic()));
    EXPECT_TRUE(is_checkpoint(here / "checkpoint.bin"));
    EXPECT_EQ(read_checkpoint(here.path()), synthetic());
    here.write("checkpoint.bin", "something else");
    EXPECT_FALSE(is_checkpoint(here / "checkpoint.bin"));
    EXPECT_THROW(read_checkpoint(here.path()), RecordError);
}

}  // namespace
}  // namespace twinchute
