// The properties that libFuzzer attacks (verify/fuzz), on random strings of bytes.

#include "fuzz/properties.hpp"
#include "support/claim.hpp"
#include "support/random.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

TEST_SUITE_BEGIN("stress");

TEST_CASE("V-STRESS-09 cell and law keep their promises for any string of bytes") {
  VERIFY_RANDOM(random, 7009);
  constexpr int strings = 100000;
  long broken = 0;
  const auto count = [&](const char* name, auto property) {
    std::array<long, 3> outcomes{};
    for (int k = 0; k < strings; ++k) {
      std::array<std::uint8_t, 112> data{};
      for (auto& b : data) b = static_cast<std::uint8_t>(random.uniform(0, 256));
      // Short strings end in zeros.
      const auto length = static_cast<std::size_t>(random.uniform(0, data.size()));
      try {
        ++outcomes[static_cast<std::size_t>(
            property(std::span<const std::uint8_t>(data.data(), length)))];
      } catch (const fuzz::Broken& error) {
        FAIL_CHECK(std::string(name) << ": " << std::string(error.what()));
        ++broken;
      }
    }
    INFO(std::string(name), ": answered ", outcomes[0], ", refused ", outcomes[1], ", no answer ",
         outcomes[2]);
    REQUIRE(outcomes[0] > strings / 10);
    REQUIRE(outcomes[1] > strings / 100);
    REQUIRE(outcomes[2] > strings / 100);
  };
  count("cell", [](auto data) { return fuzz::check_cell(data); });
  count("law", [](auto data) { return fuzz::check_law(data); });
  verify::claim("V-STRESS-09", static_cast<double>(broken), 0,
                "broken promises in 2 x 100000 random strings");
}

TEST_SUITE_END();
