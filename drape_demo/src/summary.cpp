#include "summary.hpp"

#include "fields.hpp"
#include "ledger_terms.hpp"
#include "presets.hpp"
#include "text_file.hpp"

#include "crossbeam/base/version.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <thread>
#include <vector>

namespace crossbeam::drape {
namespace {

using Json = nlohmann::ordered_json;

class JsonWriter {
 public:
  explicit JsonWriter(Json& root) : levels_{&root} { root = Json::object(); }

  void enter(const char* name) {
    Json& table = (*levels_.back())[name] = Json::object();
    levels_.push_back(&table);
  }
  void leave() { levels_.pop_back(); }
  template <class T>
  void real(const char* name, const T& value, const char*, const Range&) {
    (*levels_.back())[name] = value;
  }
  template <class T>
  void integer(const char* name, const T& value, const char*, const Range&) {
    (*levels_.back())[name] = value;
  }
  template <class E>
  void choice(const char* name, const E& value) {
    (*levels_.back())[name] = name_of(value);
  }
  void flag(const char* name, const bool& value) { (*levels_.back())[name] = value; }
  void text(const char* name, const std::string& value) { (*levels_.back())[name] = value; }
  void list(const char* name, const std::vector<double>& values, const char*) {
    (*levels_.back())[name] = values;
  }

 private:
  std::vector<Json*> levels_;
};

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "unknown";
}

Json machine_json() {
  utsname system{};
  const bool known = uname(&system) == 0;
  return {{"processor", processor()},
          {"cores", std::thread::hardware_concurrency()},
          {"system", known ? fmt::format("{} {} {}", system.sysname, system.release, system.machine)
                           : "unknown"}};
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown";
#endif
}

/// The widest vector instructions that this file, like the whole library, was compiled for.
std::string vector_instructions() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#elif defined(__AVX__)
  return "AVX";
#elif defined(__SSE2__)
  return "SSE2";
#elif defined(__ARM_NEON)
  return "NEON";
#else
  return "none";
#endif
}

Json build_json() {
#ifdef NDEBUG
  constexpr bool contracts = false;
#else
  constexpr bool contracts = true;
#endif
  return {{"compiler", compiler()},
          {"vector_instructions", vector_instructions()},
          {"contracts_checked", contracts}};
}

Json banded_json(const Banded& banded) { return {{"value", banded.value}, {"band", banded.band}}; }

Json references_json(const References& r) {
  Json study_angles = Json::array(), study_bands = Json::array();
  for (const auto& angle : r.study.shear_deg) {
    study_angles.push_back(angle.value);
    study_bands.push_back(angle.band);
  }
  return {
      {"applies_to", "fibres along the sides (layout 0); study and second code: case realistic"},
      {"net",
       {{"source", r.net.source},
        {"x", r.net.x},
        {"y", r.net.y},
        {"shear_deg", r.net.shear_deg},
        {"maximum_shear_deg", r.net.maximum_shear_deg},
        {"draw_in", {{"x", r.net.draw_in_x}, {"y", r.net.draw_in_y}}},
        {"long_edge", r.net.long_edge},
        {"short_edge", r.net.short_edge}}},
      {"study",
       {{"source", r.study.source},
        {"shear_deg", study_angles},
        {"shear_band", study_bands},
        {"slack_flange_shear_deg", r.study.slack_flange_shear_deg},
        {"maximum_shear_deg", banded_json(r.study.maximum_shear_deg)},
        {"maximum_shear_material", r.study.maximum_shear_material},
        {"draw_in", {{"x", banded_json(r.study.draw_in_x)}, {"y", banded_json(r.study.draw_in_y)}}},
        {"corner", {{"x", banded_json(r.study.corner[0])}, {"y", banded_json(r.study.corner[1])}}},
        {"shear_energy", banded_json(r.study.shear_energy)}}},
      {"second_code",
       {{"name", r.second_code.name},
        {"source", r.second_code.source},
        {"shear_deg", r.second_code.shear_deg},
        {"draw_in", {{"x", r.second_code.draw_in_x}, {"y", r.second_code.draw_in_y}}},
        {"corner", {{"x", r.second_code.corner[0]}, {"y", r.second_code.corner[1]}}}}},
  };
}

/// What the scene computes, and what it therefore does without (docs/skipping.md).
Json work_json(const DrapeCase& c, const DrapeResult& result) {
  Json used = Json::array(), skipped = Json::array();
  const auto sort = [&](bool is_used, const char* what) {
    (is_used ? used : skipped).push_back(what);
  };
  const bool energy_cell = c.fabric.formulation == CellFormulation::energy;
  const bool followed = energy_cell && c.fabric.cell_solve == CellSolve::follow;
  sort(true, c.blank.gauss_points == 1 ? "1 Gauss point" : "2x2 Gauss points");
  sort(true, c.integration.precision == Precision::float_ ? "float" : "double");
  sort(!followed, "cell solved at every step");
  sort(followed, "cell followed from step to step");
  sort(c.fabric.cell.residual_compression_stiffness > 0, "residual compression stiffness");
  sort(c.fabric.warp_bending_stiffness > 0 || c.fabric.weft_bending_stiffness > 0, "bending");
  sort(c.blank.gauss_points == 1 && c.blank.hourglass_stiffness > 0, "hourglass control");
  sort(c.integration.bulk_viscosity > 0, "bulk viscosity");
  sort(c.integration.mass_damping > 0, "mass damping");
  sort(c.contact.friction > 0, "friction");
  sort(c.contact.smoothing > 0, "smooth penalty");
  sort(!c.contact.culling, "contact of every node with every tool");
  sort(c.output.frames > 0, "output frames");
  sort(c.integration.axial_scaling > 1, "axial scaling");
  const WorkCounts& work = result.work;
  return {{"used", used},
          {"skipped", skipped},
          {"counts",
           {{"steps", result.cost.steps},
            {"steps_sampled", work.steps_sampled},
            {"gauss_points", work.gauss_points},
            {"contact_packs",
             {{"culled", work.contact_culled},
              {"flat", work.contact_flat},
              {"general", work.contact_general}}}}}};
}

std::string frame_name(std::size_t frame) { return fmt::format("frames/frame_{:04}.vtu", frame); }

}  // namespace

nlohmann::ordered_json case_json(const DrapeCase& drape_case) {
  Json json;
  JsonWriter writer(json);
  visit_fields(drape_case, writer);
  return json;
}

nlohmann::ordered_json summary_json(const DrapeCase& drape_case, const DrapeResult& result,
                                    const References& references) {
  Json json;
  json["program"] = summary_program;
  json["version"] = CROSSBEAM_VERSION;
  json["written"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  json["units"] = "mm, ms, kN, kg, deg; energies of the quarter model in kN mm";

  if (const Preset* preset = preset_of(drape_case))
    json["preset"] = {{"name", preset->name},
                      {"measured_error",
                       {{"scene", "realistic"},
                        {"against", "2.5 mm, 0.5 m/s, double"},
                        {"position", preset->error.position},
                        {"shear_rms_deg", preset->error.shear_rms_deg},
                        {"shear_quantile_deg", preset->error.shear_quantile_deg},
                        {"outline_mm", preset->error.outline_mm}}}};

  Json points = Json::array();
  for (const auto& point : result.shear_points)
    points.push_back({{"x", point.x}, {"y", point.y}, {"shear_deg", point.shear_deg}});
  json["shear_points"] = points;
  json["element_maximum"] = {{"shear_deg", result.maximum_shear_deg},
                             {"x", result.maximum_shear_material[0]},
                             {"y", result.maximum_shear_material[1]}};
  json["draw_in"] = {{"x", result.draw_in_x}, {"y", result.draw_in_y}};
  json["corner"] = {{"x", result.corner[0]}, {"y", result.corner[1]}};

  const LedgerRow last = result.ledger.empty() ? LedgerRow{} : result.ledger.back();
  Json& ledger = json["ledger"] = Json::object();
  for (const auto& term : ledger_terms) ledger[term.name] = last.*term.value;
  ledger["residual"] = last.residual;
  ledger["residual_over_punch_work"] = result.residual_over_punch_work;
  ledger["kinetic_over_punch_work_at_95"] = result.kinetic_over_punch_work_at_95;
  ledger["kinetic_over_internal_at_end"] = result.kinetic_over_internal_at_end;

  json["slack_fraction"] = result.slack_fraction;
  json["largest_yarn_tension"] = result.largest_yarn_tension;
  json["cell_fallbacks"] = result.cell_fallbacks;
  json["cost"] = {{"steps", result.cost.steps},
                  {"element_steps", result.cost.element_steps},
                  {"cpu_s", result.cost.cpu_s},
                  {"wall_s", result.cost.wall_s},
                  {"ns_per_element_step", result.cost.ns_per_element_step},
                  {"time_step_ms", result.cost.time_step_ms},
                  {"elements", result.quads.size()}};
  json["work"] = work_json(drape_case, result);
  json["case"] = case_json(drape_case);
  json["machine"] = machine_json();
  json["build"] = build_json();
  json["references"] = references_json(references);
  return json;
}

std::string shear_points_csv(const DrapeResult& result) {
  std::string csv = "point,x [mm],y [mm],shear [deg]\n";
  for (std::size_t i = 0; i < result.shear_points.size(); ++i) {
    const auto& point = result.shear_points[i];
    csv += fmt::format("{},{:.10g},{:.10g},{:.10g}\n", i + 1, point.x, point.y, point.shear_deg);
  }
  return csv;
}

std::string outline_csv(const DrapeResult& result) {
  std::string csv = "x [mm],y [mm]\n";
  for (const auto& point : result.outline)
    csv += fmt::format("{:.10g},{:.10g}\n", point[0], point[1]);
  return csv;
}

std::string energy_csv(const DrapeResult& result) {
  std::string csv = "time [ms],stroke [mm]";
  for (const auto& term : ledger_terms) csv += fmt::format(",{} [kN mm]", term.name);
  csv += ",residual [kN mm]\n";
  for (const auto& row : result.ledger) {
    csv += fmt::format("{:.10g},{:.10g}", row.time, row.stroke);
    for (const auto& term : ledger_terms) csv += fmt::format(",{:.10g}", row.*term.value);
    csv += fmt::format(",{:.10g}\n", row.residual);
  }
  return csv;
}

FrameWriter::FrameWriter(const std::filesystem::path& folder) : folder_(folder) {
  std::filesystem::create_directory(folder_ / "frames");
}

void FrameWriter::write(const std::vector<std::array<int, 4>>& quads, const Frame& frame) {
  const std::string name = frame_name(files_.size());
  write_vtu(folder_ / name, quads, frame);
  files_.push_back({frame.time, name});
}

void write_result(const std::filesystem::path& folder, const DrapeCase& drape_case,
                  const DrapeResult& result, const std::vector<FrameFile>& frames,
                  const References& references) {
  write_pvd(folder / "drape.pvd", frames);
  write_file(folder / "shear_points.csv", shear_points_csv(result));
  write_file(folder / "outline.csv", outline_csv(result));
  write_file(folder / "energy.csv", energy_csv(result));
  write_file(folder / "summary.json", summary_json(drape_case, result, references).dump(2) + "\n");
}

}  // namespace crossbeam::drape
