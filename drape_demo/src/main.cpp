/// @file
/// crossbeam-drape: the double dome from the command line to a folder of results.

#include "drape.hpp"
#include "formed_part.hpp"
#include "interrupt.hpp"
#include "options.hpp"
#include "output_folder.hpp"
#include "progress.hpp"
#include "references.hpp"
#include "spelling.hpp"
#include "standard_streams.hpp"
#include "summary.hpp"
#include "supplied.hpp"
#include "table.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

namespace {

namespace drape = crossbeam::drape;

enum ExitCode { done = 0, not_written = 1, bad_input = 2, run_failed = 3, signalled = 128 };

/// @param beside what is not lost when the text is
void print(const std::string& text, const std::string& beside) {
  if (!drape::write_stream(stdout, drape::printable(text, true)))
    throw std::runtime_error(fmt::format("cannot write to standard output: {}{}",
                                         std::strerror(errno != 0 ? errno : EIO), beside));
}

drape::DrapeResult run(const drape::Options& options, drape::FrameWriter& frames) {
  const drape::Progress progress(drape::Progress::style_for(options.quiet));
  try {
    return drape::run(
        options.drape_case, progress,
        [&frames](const auto& quads, const auto& frame) { frames.write(quads, frame); });
  } catch (const std::bad_alloc&) {
    const drape::BlankInput& blank = options.drape_case.blank;
    throw crossbeam::RunError(
        fmt::format("out of memory with a mesh of {} elements of {:g} mm: a larger "
                    "blank.element_size (--mesh) needs less, by the square",
                    drape::quarter_grid(blank).element_count(), blank.element_size));
  }
}

int drape_once(const drape::Options& options) {
  const drape::References references = drape::supplied_references();
  drape::OutputFolder folder(options.out);
  drape::FrameWriter frames(folder.path());
  const drape::DrapeResult result = run(options, frames);
  drape::write_result(folder.path(), options.drape_case, result, frames.files(), references);
  folder.commit();

  const std::string place = "results in " + folder.target().string();
  if (!options.quiet)
    print(drape::result_table(options.drape_case, result, references) + place + "\n", "; " + place);
  return done;
}

int report(int code, const std::string& what) {
  // Where nobody can read it, the exit code still tells.
  static_cast<void>(
      drape::write_stream(stderr, drape::printable("crossbeam-drape: " + what + "\n", true)));
  return code;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    drape::hold_standard_streams();
    drape::catch_interrupts();
    const drape::Options options = drape::parse_options({arguments + 1, arguments + count});
    if (options.message.empty()) return drape_once(options);
    print(options.message, "");
    return done;
  } catch (const drape::Interrupted& error) {
    return report(signalled + error.signal(),
                  fmt::format("interrupted ({}); nothing was written", strsignal(error.signal())));
  } catch (const crossbeam::InputError& error) {
    return report(bad_input, error.what());
  } catch (const crossbeam::RunError& error) {
    return report(run_failed, error.what());
  } catch (const std::bad_alloc&) {
    return report(run_failed, "out of memory");
  } catch (const std::exception& error) {
    return report(not_written, error.what());
  }
}
