#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

namespace verify {

namespace {

void log(const std::string& line) {
  const char* path = std::getenv("CROSSBEAM_CLAIMS_LOG");
  if (path == nullptr || *path == '\0') return;
  if (!crossbeam::verification::append_line(path, line))
    FAIL_CHECK("CROSSBEAM_CLAIMS_LOG = " << path << " cannot be written");
}

}  // namespace

void claim(const Measurement& m) {
  CHECK_MESSAGE(m.pass(), m.claim, ": ", m.note, ": measured ", m.measured,
                m.bound == Bound::upper ? ", has to be <= " : ", has to be >= ", m.tolerance);
  log(to_json(m));
}
void claim(const std::string& id, double measured, double tolerance, const std::string& note,
           Bound bound) {
  claim({id, measured, tolerance, note, bound});
}

void show(const Plot& plot) { log(to_json(plot)); }
void show(const Map& map) { log(to_json(map)); }

void Worst::claim(const std::string& id, double tolerance, const std::string& note) const {
  REQUIRE_MESSAGE(seen() > 0, id, ": nothing was measured");
  INFO("worst at: ", where());
  verify::claim(id, value(), tolerance, note);
}

}  // namespace verify
