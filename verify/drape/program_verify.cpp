// The program as its users meet it: started by a shell, with streams and signals as shells have
// them.

#include "scene.hpp"
#include "supplied.hpp"

#include "drape/scratch_folder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <fcntl.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using namespace crossbeam::drape;
using verify::file_content;
using verify::ScratchFolder;

/// A coarse mesh and a short stroke: a tenth of a second or so.
const std::string short_run = "name = 'short'\n[blank]\nelement_size = 30\n[process]\nstroke = 2\n";
/// One that nobody waits for.
const std::string long_run =
    "name = 'long'\n[blank]\nelement_size = 30\n[process]\nspeed = 0.005\n"
    "[integration]\nstep_limit = 1000000000\n";

/// The program in an empty folder, with a scene file there.
class Program {
 public:
  explicit Program(const std::string& scene = short_run) {
    std::ofstream(folder / "scene.toml") << scene;
  }

  /// What a shell gives for a command in that folder; $D is the program with this scene and --out
  /// out.
  [[nodiscard]] int shell(const std::string& command) const {
    std::ofstream(folder / "command")
        << "cd '" << folder.path().string() << "'\nD='" << CROSSBEAM_DRAPE_PROGRAM
        << " --case scene.toml --out out'\n"
        << command << "\n";
    const int status =
        std::system(("bash '" + (folder / "command").string() + "' > /dev/null").c_str());
    REQUIRE(WIFEXITED(status));
    return WEXITSTATUS(status);
  }
  [[nodiscard]] std::string content(const std::string& name) const {
    return file_content(folder / name);
  }
  [[nodiscard]] bool has_result() const { return fs::exists(folder / "out/summary.json"); }
  [[nodiscard]] int hidden() const {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      count += entry.path().filename().string()[0] == '.' ? 1 : 0;
    return count;
  }
  /// Until the run has its hidden folder, and so all its handlers.
  [[nodiscard]] bool has_begun() const {
    for (int k = 0; k < 500 && hidden() == 0; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return hidden() > 0;
  }

  ScratchFolder folder;
};

void check_contains(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts)
    CHECK_MESSAGE(text.find(part) != std::string::npos, "\"", text, "\" lacks \"", part, "\"");
}

}  // namespace

TEST_SUITE_BEGIN("drape");

TEST_CASE("V-IO-16 exactly the frames that were asked for are written, from the start to the end") {
  for (const int frames : {1, 2, 7, 300}) {
    CAPTURE(frames);
    const Program program(short_run + "[output]\nframes = " + std::to_string(frames) + "\n");
    REQUIRE(program.shell("$D --quiet") == 0);
    int files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(program.folder / "out/frames"))
      ++files;
    CHECK(files == frames);
    const std::string pvd = program.content("out/drape.pvd");
    CHECK((pvd.find("timestep=\"0\"") != std::string::npos) == (frames > 1));
    std::size_t listed = 0;
    for (std::size_t at = 0; (at = pvd.find("<DataSet", at)) != std::string::npos; ++at) ++listed;
    CHECK(listed == static_cast<std::size_t>(frames));
  }
}

TEST_CASE("V-IO-16 memory does not grow with the frames") {
  // Peak of the child that used most, in kB. Each frame of this mesh has a megabyte.
  const auto peak = [](const std::string& frames) {
    const Program program(
        "name = 'short'\n[blank]\nelement_size = 3\n[process]\nstroke = 1\n"
        "speed = 4\n[output]\nframes = " +
        frames + "\n");
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      if (chdir(program.folder.path().c_str()) != 0) _exit(9);
      execl(CROSSBEAM_DRAPE_PROGRAM, CROSSBEAM_DRAPE_PROGRAM, "--case", "scene.toml", "--out",
            "out", "--quiet", static_cast<char*>(nullptr));
      _exit(9);
    }
    int status = 0;
    rusage usage{};
    REQUIRE(wait4(child, &status, 0, &usage) == child);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    return usage.ru_maxrss;
  };
  const long few = peak("2"), many = peak("100");
  MESSAGE("peak memory [kB]: ", few, " with 2 frames, ", many, " with 100");
  CHECK(many < few + 10'000);
}

TEST_CASE(
    "V-IO-17 a run that cannot end is refused with both numbers, and a higher limit admits it") {
  const Program program;
  CHECK(program.shell("$D --speed 1e-9 2> err") == 2);
  check_contains(program.content("err"), {"integration.step_limit = 10000000", "at least the",
                                          "steps of this run", "process.speed"});
  CHECK(program.hidden() == 0);
  const Program limited(short_run + "[integration]\nstep_limit = 10\n");
  CHECK(limited.shell("$D 2> err") == 2);
  check_contains(limited.content("err"), {"integration.step_limit = 10"});
  const Program frames(short_run + "[output]\nframes = 10000\n");
  CHECK(frames.shell("$D --speed 100 2> err") == 2);
  check_contains(frames.content("err"),
                 {"output.frames = 10000", "at most one more than the steps"});
}

TEST_CASE("V-IO-18 streams that are closed, full or read by nobody cost no result") {
  const Program program;
  SUBCASE("standard error closed or full") {
    CHECK(program.shell("$D 2>&- && $D 2> /dev/full") == 0);
    CHECK(program.has_result());
  }
  SUBCASE("all of them closed: no file gets the messages") {
    CHECK(program.shell("$D <&- >&- 2>&-") == 1);
    CHECK(program.has_result());
    CHECK(program.content("out/summary.json")[0] == '{');
    CHECK(program.content("out/energy.csv").rfind("time [ms]", 0) == 0);
  }
  SUBCASE("standard output full or closed: said, and by the exit code") {
    CHECK(program.shell("$D > /dev/full 2> err") == 1);
    CHECK(program.has_result());
    check_contains(program.content("err"),
                   {"cannot write to standard output", "results in", "out"});
    CHECK(program.shell("$D >&- 2> err") == 1);
    CHECK(program.shell("$D --help > /dev/full 2> err") == 1);
    CHECK(program.shell("$D --quiet > /dev/full") == 0);
  }
  SUBCASE("a reader that goes") {
    CHECK(program.shell("set -o pipefail; $D 2>&1 | head -1; (( PIPESTATUS[0] == 1 ))") == 0);
    CHECK(program.has_result());
  }
  CHECK(program.hidden() == 0);
}

namespace {

/// The long run as a child process, which is sent a signal once it runs.
/// @param ignored by whoever starts it
/// @return its wait status
int run_and_signal(const Program& program, int signal, bool ignored) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::signal(signal, ignored ? SIG_IGN : SIG_DFL);
    const int err = open((program.folder / "err").c_str(), O_WRONLY | O_CREAT, 0666);
    dup2(err, STDERR_FILENO);
    if (chdir(program.folder.path().c_str()) == 0)
      execl(CROSSBEAM_DRAPE_PROGRAM, CROSSBEAM_DRAPE_PROGRAM, "--case", "scene.toml", "--out",
            "out", static_cast<char*>(nullptr));
    _exit(9);
  }
  REQUIRE(program.has_begun());
  REQUIRE(kill(child, signal) == 0);
  if (ignored) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    int status = 0;
    CHECK(waitpid(child, &status, WNOHANG) == 0);  // it goes on
    kill(child, SIGTERM);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return status;
}

}  // namespace

TEST_CASE("V-IO-19 signals that ask to end leave nothing behind") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM}) {
    CAPTURE(signal);
    const Program program(long_run);
    const int status = run_and_signal(program, signal, false);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + signal);
    CHECK(program.hidden() == 0);
    CHECK_FALSE(fs::exists(program.folder / "out"));
    check_contains(program.content("err"), {"interrupted", "nothing was written"});
  }
}

TEST_CASE("V-IO-19 a signal that the caller ignores stays ignored") {
  for (const int signal : {SIGINT, SIGHUP, SIGQUIT}) {  // nohup, and shells in the background
    CAPTURE(signal);
    const Program program(long_run);
    const int status = run_and_signal(program, signal, true);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + SIGTERM);
    CHECK(program.hidden() == 0);
  }
}

TEST_CASE("V-IO-20 what the system does not give is an error that says so") {
  const Program program;
  SUBCASE("threads") {
    // 400 MB of addresses: room for the run, but not for the stacks of 64 threads of 8 MB.
    CHECK(program.shell("ulimit -s 8192 -v 400000; $D --threads 64 2> err") == 2);
    check_contains(program.content("err"), {"threads = 64", "at most", "system lets"});
    CHECK(program.hidden() == 0);
  }
  SUBCASE("memory") {
    CHECK(program.shell("ulimit -v 600000; $D --mesh 0.2 2> err") == 3);
    check_contains(program.content("err"), {"out of memory", "elements of 0.2 mm", "--mesh"});
    CHECK(program.hidden() == 0);
  }
}

TEST_CASE("V-IO-21 the program needs no folder of its own") {
  const Program program;
  fs::copy_file(CROSSBEAM_DRAPE_PROGRAM, program.folder / "moved");
  // Scenes and references are compiled in; the files of the same name are what is in the program.
  for (const auto& file : supplied_files())
    CHECK(file_content(scene_folder() / std::string(file.name)) == file.text);
  CHECK(supplied_files().size() == 4);
  CHECK(program.shell("./moved --case scene.toml --out moved-out --quiet") == 0);
  CHECK(fs::exists(program.folder / "moved-out/summary.json"));
}

TEST_CASE("V-IO-15 a large mesh says at once what is being built") {
  const Program program;
  REQUIRE(program.shell("$D 2> err") == 0);
  const std::string err = program.content("err");
  CHECK(err.rfind("building the model: 40 elements\n", 0) == 0);
}

TEST_SUITE_END();
