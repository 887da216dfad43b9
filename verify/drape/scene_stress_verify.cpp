// Scene files of any content: a case that can be run, or a refusal with file and line.

#include "fuzz/scene_properties.hpp"
#include "support/claim.hpp"
#include "support/random.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

/// The supplied scenes and a few short ones: what the mutations start from.
std::vector<std::string> seeds() {
  std::vector<std::string> out{
      "",
      "fabric.shear.kind = 'tabulated'\nfabric.shear.angle = [0, 0.5]\nfabric.shear.traction = [0, "
      "1e-4]\n",
      "[blank]\nhalf_width = 3.0\n",
      "integration.precision = 'float'\nfabric.cell.warp.length = 1e-3\n"};
  for (const auto& entry : std::filesystem::directory_iterator(crossbeam::drape::scene_folder())) {
    std::ifstream file(entry.path(), std::ios::binary);
    out.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return out;
}

/// One small change: a byte, a piece moved, a value replaced by one that numbers' readers fear.
void mutate(std::string& text, verify::Random& random) {
  const auto place = [&] {
    return static_cast<std::size_t>(random.uniform(0, static_cast<double>(text.size() + 1)));
  };
  const std::vector<std::string> pieces{"nan",
                                        "-inf",
                                        "1e400",
                                        "9007199254740993",
                                        "9223372036854775807",
                                        "-9223372036854775808",
                                        "99999999999999999999",
                                        "0x7fffffffffffffff",
                                        "1e-320",
                                        "-0.0",
                                        "1e150",
                                        "'",
                                        "\"\"\"",
                                        "[[",
                                        "]]",
                                        "{",
                                        "}",
                                        ".",
                                        "=",
                                        "\n[fabric]\n",
                                        "\r",
                                        "\xff",
                                        "\xef\xbb\xbf",
                                        "#",
                                        ",",
                                        "true",
                                        "1979-05-27T07:32:00Z",
                                        "\\u0000",
                                        "a.b.c.d = 1\n",
                                        "[fabric.cell]\n",
                                        "inf",
                                        "0"};
  const double kind = random.uniform(0, 4);
  if (kind < 1 && !text.empty()) {
    text[place() % text.size()] = static_cast<char>(static_cast<int>(random.uniform(0, 256)));
  } else if (kind < 2) {
    const std::size_t at = place();
    text.erase(at, static_cast<std::size_t>(random.uniform(1, 30)));
  } else if (kind < 3) {
    text.insert(
        place(),
        pieces[static_cast<std::size_t>(random.uniform(0, static_cast<double>(pieces.size())))]);
  } else {
    // The value of some line.
    const std::size_t equals = text.find("= ", place());
    if (equals == std::string::npos) return;
    const std::size_t end = text.find_first_of("#\n", equals);
    text.replace(
        equals + 2, end == std::string::npos ? end : end - equals - 2,
        pieces[static_cast<std::size_t>(random.uniform(0, static_cast<double>(pieces.size())))] +
            " ");
  }
}

}  // namespace

TEST_SUITE_BEGIN("stress");

TEST_CASE("V-STRESS-10 any text is a scene that can be run or is refused with file and line") {
  VERIFY_RANDOM(random, 7010);
  const auto texts = seeds();
  REQUIRE(texts.size() >= 6);
  long broken = 0, accepted = 0, refused = 0;
  const auto ask = [&](const std::string& text) {
    try {
      (fuzz::check_scene(text) == fuzz::Outcome::answered ? accepted : refused) += 1;
    } catch (const fuzz::Broken& error) {
      FAIL_CHECK(std::string(error.what()) << "\nin the text\n" << text);
      ++broken;
    }
  };
  for (int k = 0; k < 6000; ++k) {
    std::string text = texts[static_cast<std::size_t>(k) % texts.size()];
    const int changes = k < static_cast<int>(texts.size()) ? 0 : 1 + k % 4;
    for (int change = 0; change < changes; ++change) mutate(text, random);
    ask(text);
  }
  // Depth and length are no way to take the program down.
  ask("a = " + std::string(100000, '['));
  ask("fabric.shear.coefficients = [" + std::string(20000, '1') + "]");
  ask(std::string(1000, 'a') + "." + std::string(100000, 'b') + " = 1");
  std::string many;
  for (int k = 0; k < 5000; ++k) many += "a" + std::to_string(k) + ".";
  ask(many + "z = 1");
  // A whole number that no double holds, and a list that goes on with a brace: toml++ has no double
  // for the one and an assertion against the other.
  CHECK(crossbeam::drape::parse_scene("fabric.cell.contact_area = 9007199254740993", "x")
            .fabric.cell.contact_area == 9007199254740992.0);
  try {
    static_cast<void>(crossbeam::drape::parse_scene(
        "name = 'a'\nfabric.shear.coefficients = [\n1.0,\n} 2.0]\nprocess.hold = 1", "brace.toml"));
    FAIL_CHECK("a brace in a list was accepted");
  } catch (const crossbeam::InputError& error) {
    CHECK(std::string(error.what()).find("brace.toml:4") != std::string::npos);
  }
  REQUIRE(accepted > 100);
  REQUIRE(refused > 1000);
  verify::claim("V-STRESS-10", static_cast<double>(broken), 0,
                "texts accepted that cannot be run, or refused without a line (6000 random texts)");
}

TEST_SUITE_END();
