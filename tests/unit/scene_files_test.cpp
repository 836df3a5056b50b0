// Where data files are looked for, safe names, and the fingerprint of a scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "lib/math/sha256.hpp"
#include "lib/scene/data_files.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

namespace fs = std::filesystem;

TEST(Sha256, VectorsOfTheStandard) {
    // NIST, examples with intermediate values for SHA-256, and SHA256ShortMsg/LongMsg of the CAVP.
    EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(sha256_hex("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmno"
                         "ijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu"),
              "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
    EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    EXPECT_EQ(sha256_hex("\xbd"), "68325720aabd7c82f30f554b313d0570c95accbb7dc4b5aae11204c08ffe732b");
}

TEST(Sha256, PaddingAtEveryLengthOfABlock) {
    // n zero bytes around the length where padding needs another block; from Python 3 hashlib (OpenSSL).
    const std::pair<std::size_t, const char*> zeros[] = {
        {55, "02779466cdec163811d078815c633f21901413081449002f24aa3e80f0b88ef7"},
        {56, "d4817aa5497628e7c77e6b606107042bbba3130888c5f47a375e6179be789fbb"},
        {57, "65a16cb7861335d5ace3c60718b5052e44660726da4cd13bb745381b235a1785"},
        {63, "c7723fa1e0127975e49e62e753db53924c1bd84b8ac1ac08df78d09270f3d971"},
        {64, "f5a5fd42d16a20302798ef6ed309979b43003d2320d9f0e8ea9831a92759fb4b"},
        {65, "98ce42deef51d40269d542f5314bef2c7468d401ad5d85168bfab4c0108f75f7"},
    };
    for (const auto& [count, hex] : zeros)
        EXPECT_EQ(sha256_hex(std::string(count, '\0')), hex) << count;
}

TEST(DataNames, StayInTheirFolder) {
    for (const char* good : {"usaf-c9", "a", "A_1.b", "x..y", "paper/crane-drop"})
        EXPECT_TRUE(is_data_name(good)) << good;
    for (const char* bad : {"", ".", "..", "../x", "a/../b", "a/", "a//b", "a/.b", "/etc/passwd", "a\\b",
                            "a b", ".hidden", "a\n", "~"})
        EXPECT_FALSE(is_data_name(bad)) << bad;
    EXPECT_FALSE(find_data_file("parachutes", "../parachutes/usaf-c9", TWINCHUTE_SOURCE_DIR "/data"));
    EXPECT_FALSE(is_data_name(std::string("a\0b", 3)));
}

TEST(DataFiles, BesideTheSceneThenEnvironmentThenSource) {
    const fs::path root = fs::path(testing::TempDir()) / "twinchute_data_files";
    fs::remove_all(root);
    for (const char* place : {"beside", "environment"})
        fs::create_directories(root / place / "parachutes");
    const auto found = [&] { return find_data_file("parachutes", "usaf-c9", root / "beside").value(); };

    const fs::path source = found();  // installed or in the source tree
    EXPECT_EQ(source.filename(), "usaf-c9.toml");
    EXPECT_NE(source.string().find("data"), std::string::npos);

    std::ofstream(root / "environment" / "parachutes" / "usaf-c9.toml") << "";
    ::setenv("TWINCHUTE_DATA", (root / "environment").c_str(), 1);
    EXPECT_EQ(found(), root / "environment" / "parachutes" / "usaf-c9.toml");

    std::ofstream(root / "beside" / "parachutes" / "usaf-c9.toml") << "";
    std::ofstream(root / "beside" / "parachutes" / "mine.toml") << "";
    EXPECT_EQ(found(), root / "beside" / "parachutes" / "usaf-c9.toml");
    ::unsetenv("TWINCHUTE_DATA");

    const auto names = data_names("parachutes", root / "beside");
    EXPECT_EQ(std::ranges::count(names, "mine"), 1);
    EXPECT_EQ(std::ranges::count(names, "usaf-c9"), 1);  // once, though it is in two places
    EXPECT_TRUE(std::ranges::is_sorted(names));
    fs::remove_all(root);
}

TEST(DataFiles, ATypeOfCanopyIsNoDesign) {
    for (const std::string& name : data_names("parachutes"))
        EXPECT_FALSE(name.starts_with("types/")) << name;
    EXPECT_GT(data_names("parachutes/types").size(), 10u);
    const std::string said = complaint(edited(good_scene, "usaf-c9", "c10"));
    EXPECT_NE(said.find("there is no parachutes/c10.toml"), std::string::npos) << said;
    EXPECT_EQ(said.find("types/"), std::string::npos) << said;
}

TEST(DataFiles, ASceneUsesTheDesignBesideIt) {
    const fs::path root = fs::path(testing::TempDir()) / "twinchute_own_design";
    fs::create_directories(root / "parachutes");
    std::string design = read_text_file(TWINCHUTE_SOURCE_DIR "/data/parachutes/usaf-c9.toml");
    std::ofstream(root / "parachutes" / "mine.toml") << edited(design, "\"8.53 m\"", "\"9 m\"");
    std::ofstream(root / "scene.toml") << edited(good_scene, "usaf-c9", "mine");
    EXPECT_EQ(read_scene(root / "scene.toml").parachutes[0].nominal_diameter, 9.0);
    fs::remove_all(root);
}

TEST(FileStem, IsSafeAndReadable) {
    EXPECT_EQ(file_stem_of("c9-inflation"), "c9-inflation");
    EXPECT_EQ(file_stem_of("C-9 crane drop, Fr 5.3"), "C-9-crane-drop-Fr-5.3");
    EXPECT_EQ(file_stem_of("../../etc/passwd"), "etc-passwd");
    EXPECT_EQ(file_stem_of("-rf *"), "rf");
    EXPECT_EQ(file_stem_of("..."), "scene");
    EXPECT_EQ(file_stem_of(""), "scene");
    EXPECT_EQ(file_stem_of("a\nb\tc"), "a-b-c");
    EXPECT_EQ(file_stem_of(std::string(500, 'x')).size(), 80u);
    for (const char* name : {"a/../b", "\\\\server\\x", "\xc3\xa9t\xc3\xa9", "con:"})
        EXPECT_TRUE(is_data_name(file_stem_of(name))) << name;
}

TEST(ReadTextFile, KeepsEveryByte) {
    const fs::path file = fs::path(testing::TempDir()) / "twinchute_bytes.toml";
    const std::string bytes("a\r\n\0b\xff", 6);
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(read_text_file(file), bytes);
    std::ofstream(file, std::ios::binary) << std::string((4 << 20) + 1, ' ');
    EXPECT_THROW(read_text_file(file), SceneError);
    fs::remove(file);
}

}  // namespace
}  // namespace twinchute::test
