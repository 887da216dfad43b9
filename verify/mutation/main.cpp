// The kill suite: the verification's own tests, compiled against instrumented headers.
//   CROSSBEAM_MUTANT=<site>:<variant>    run with this mutant switched on
//   CROSSBEAM_MUTANT_SECONDS=<number>    processor time after which it is stopped by SIGVTALRM
//   CROSSBEAM_MUTANT_MEGABYTES=<number>  address space that it gets
//   CROSSBEAM_MUTATION_COVERAGE=<file>   note which sites each test reaches, and how long it takes
// Exit status: 0 all tests pass, 1 one failed; where they pass with a mutant: 70 its site was not
// reached, 71 it never changed a value, 77 it makes no sense for the types at hand.

#define DOCTEST_CONFIG_IMPLEMENT
#include "mutation/proxies.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <sys/resource.h>
#include <sys/time.h>

namespace crossbeam::mutation {

unsigned char flag[most_sites];

namespace {
bool coverage = false, hit[most_sites];
int active_variant = 0;
bool was_reached = false, was_applied = false, has_differed = false, was_senseless = false;
}  // namespace

int reached(int site) {
  if (coverage) {
    hit[site] = true;
    flag[site] = 0;
    return 0;
  }
  was_reached = true;
  return active_variant;
}
void not_applicable() { was_senseless = true; }
void applied(bool differs) {
  was_applied = true;
  has_differed = has_differed || differs;
}

namespace {

struct Coverage : doctest::IReporter {
  std::FILE* file = nullptr;
  doctest::String name;
  std::clock_t begin = 0;

  explicit Coverage(const doctest::ContextOptions&) {
    if (const char* path = std::getenv("CROSSBEAM_MUTATION_COVERAGE")) file = std::fopen(path, "w");
  }
  ~Coverage() override {
    if (file) std::fclose(file);
  }
  void test_case_start(const doctest::TestCaseData& test) override {
    name = test.m_name;
    std::memset(hit, 0, sizeof hit);
    if (coverage) std::memset(flag, 1, sizeof flag);
    begin = std::clock();
  }
  /// name <tab> seconds of processor time <tab> sites
  void test_case_end(const doctest::CurrentTestCaseStats&) override {
    if (!file) return;
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::fprintf(file, "%s\t%.4f\t", name.c_str(), seconds);
    for (int site = 0; site < most_sites; ++site)
      if (hit[site]) std::fprintf(file, "%d ", site);
    std::fprintf(file, "\n");
  }
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
DOCTEST_REGISTER_LISTENER("coverage", 1, Coverage);

int status(int test_result) {
  if (test_result != 0 || active_variant == 0) return test_result;
  if (!was_reached) return 70;
  if (!was_applied && was_senseless) return 77;
  return has_differed ? 0 : 71;
}

}  // namespace
}  // namespace crossbeam::mutation

int main(int count, char** arguments) {
  using namespace crossbeam::mutation;
  coverage = std::getenv("CROSSBEAM_MUTATION_COVERAGE") != nullptr;
  if (const char* mutant = std::getenv("CROSSBEAM_MUTANT")) {
    int site = 0;
    if (std::sscanf(mutant, "%d:%d", &site, &active_variant) != 2 || site < 0 ||
        site >= most_sites) {
      std::fprintf(stderr, "CROSSBEAM_MUTANT = %s is not <site>:<variant>\n", mutant);
      return 2;
    }
    flag[site] = 1;
  }
  if (const char* seconds = std::getenv("CROSSBEAM_MUTANT_SECONDS")) {
    // Processor time: the load of the machine must not kill a mutant.
    const double limit = std::strtod(seconds, nullptr);
    itimerval timer{};
    timer.it_value.tv_sec = static_cast<time_t>(limit);
    timer.it_value.tv_usec = static_cast<suseconds_t>((limit - std::floor(limit)) * 1e6);
    setitimer(ITIMER_VIRTUAL, &timer, nullptr);
  }
  if (const char* megabytes = std::getenv("CROSSBEAM_MUTANT_MEGABYTES")) {
    const rlim_t bytes = std::strtoull(megabytes, nullptr, 10) << 20;
    const rlimit memory{bytes, bytes}, core{0, 0};
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &core);
  }
  doctest::Context context;
  context.applyCommandLine(count, arguments);
  return status(context.run());
}
