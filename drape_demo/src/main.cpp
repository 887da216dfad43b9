/// @file
/// crossbeam-drape: the double dome from the command line to a folder of results.

#include "drape.hpp"
#include "interrupt.hpp"
#include "options.hpp"
#include "output_folder.hpp"
#include "progress.hpp"
#include "references.hpp"
#include "scene.hpp"
#include "summary.hpp"
#include "table.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

namespace {

namespace drape = crossbeam::drape;

enum ExitCode { done = 0, not_written = 1, bad_input = 2, run_failed = 3, interrupted = 130 };

int drape_once(const drape::Options& options) {
  const drape::References references =
      drape::load_references(drape::scene_folder() / "references.toml");
  drape::OutputFolder folder(options.out);

  const drape::DrapeResult result = [&options] {
    const drape::Progress progress(drape::Progress::style_for(options.quiet));
    return drape::run(options.drape_case, progress);
  }();
  drape::write_result(folder.path(), options.drape_case, result, references);
  folder.commit();

  if (!options.quiet) {
    fmt::print("{}", drape::result_table(options.drape_case, result, references));
    fmt::print("results in {}\n", folder.target().string());
  }
  return done;
}

int report(ExitCode code, const char* what) {
  fmt::print(stderr, "crossbeam-drape: {}\n", what);
  return code;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    drape::catch_interrupts();
    const drape::Options options = drape::parse_options({arguments + 1, arguments + count});
    if (!options.message.empty()) {
      fmt::print("{}", options.message);
      return done;
    }
    return drape_once(options);
  } catch (const drape::Interrupted&) {
    return report(interrupted, "interrupted; nothing was written");
  } catch (const crossbeam::InputError& error) {
    return report(bad_input, error.what());
  } catch (const crossbeam::RunError& error) {
    return report(run_failed, error.what());
  } catch (const std::exception& error) {
    return report(not_written, error.what());
  }
}
