#include "drape.hpp"

#include "formed_part.hpp"
#include "quarter_model.hpp"

#include "crossbeam/crossbeam.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>

namespace crossbeam::drape {

namespace {

constexpr double pi = std::numbers::pi;

/// CPU time of this thread, or of all threads of the process [s].
double cpu_seconds(int threads) {
  timespec t{};
  clock_gettime(threads > 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// The steps before which a frame is taken: the first at the start, the last at the end, the others
/// evenly between. A single one is the end.
class FrameSteps {
 public:
  FrameSteps(std::int64_t steps, std::int64_t frames) : steps_(steps), frames_(frames) {
    if (frames - 1 > steps)
      throw InputError("output.frames", std::to_string(frames), "",
                       "at most one more than the steps of the run, " + std::to_string(steps + 1));
  }
  std::int64_t operator[](std::int64_t frame) const {
    if (frame + 1 >= frames_) return steps_;
    return steps_ * frame / (frames_ - 1);
  }

 private:
  std::int64_t steps_, frames_;
};

/// A quarter drape in one precision: mesh, blocks, tools and the loop.
template <class R>
class QuarterDrape {
 public:
  using T = NativePack<R>;

  explicit QuarterDrape(const DrapeCase& c)
      : case_(c),
        built_(c),
        integrator_(integrator_of(built_.release(), c.integration.step_factor)) {
    // Faster than sound in the yarns nothing in this model moves, unless the yarns are softer than
    // the punch is slow.
    const double bound = CrossedBeamCell<double>(c.fabric.cell).membrane_stiffness_bound();
    integrator_.set_speed_limit(
        std::max(std::sqrt(bound / c.fabric.areal_mass), 100 * c.process.speed));
    integrator_.set_threads(c.integration.threads);
  }

  DrapeResult run(const Progress& progress, const FrameSink& sink) {
    const auto wall_start = std::chrono::steady_clock::now();
    const double cpu_start = cpu_seconds(case_.integration.threads);
    const double dt = integrator_.time_step();
    const double duration = punch_.duration * (1 + case_.process.hold);
    const std::int64_t steps = checked_steps(duration, dt);
    const std::int64_t sample_every =
        std::max<std::int64_t>(1, steps / case_.output.ledger_samples);
    const FrameSteps frame_steps(steps, case_.output.frames);
    std::int64_t frames = 0;  // that were handed out
    // Seldom enough to cost nothing, and often enough that Ctrl-C is noticed on a large mesh too.
    const std::int64_t update_every =
        std::clamp<std::int64_t>(2'000'000 / mesh_.element_count(), 4, 128);
    for (int e = 0; e < mesh_.element_count(); ++e) result_.quads.push_back(mesh_.elements[e]);
    for (std::int64_t n = 0; n < steps;) {
      const double stroke = punch_(integrator_.time());
      if (n == frame_steps[frames]) {
        if (sink) sink(result_.quads, frame(stroke));
        ++frames;
      }
      if (n % update_every == 0)
        progress.update(static_cast<double>(n) / static_cast<double>(steps), stroke);
      if (n % sample_every == 0 || n + 1 == steps) {
        EnergyLedger ledger;
        integrator_.step(&ledger);
        ++n;
        ++result_.work.steps_sampled;
        book(ledger, stroke);
        check_elements(stroke);
      } else {
        std::int64_t next = std::min(steps - 1, frame_steps[frames]);
        for (const std::int64_t every : {update_every, sample_every})
          next = std::min(next, (n / every + 1) * every);
        integrator_.advance(next - n);
        n = next;
      }
    }
    result_.formed = frame(punch_(integrator_.time()));
    if (sink) sink(result_.quads, result_.formed);
    progress.update(1.0, case_.process.stroke);
    measure();
    Cost& cost = result_.cost;
    cost.steps = steps;
    cost.element_steps = steps * mesh_.element_count();
    cost.cpu_s = cpu_seconds(case_.integration.threads) - cpu_start;
    cost.wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
    cost.ns_per_element_step = 1e9 * cost.cpu_s / static_cast<double>(cost.element_steps);
    cost.time_step_ms = dt;
    for (const auto& block : integrator_.blocks()) result_.cell_fallbacks += block->fallbacks();
    count_work(steps);
    return std::move(result_);
  }

 private:
  /// A factor above 1 is the user's own risk.
  static CentralDifference<T> integrator_of(Model<R> model, double step_factor) {
    const double dt = step_factor * model.critical_step();
    return CentralDifference<T>(std::move(model), TimeStep::fixed(dt));
  }

  /// How many steps the run takes.
  [[nodiscard]] std::int64_t checked_steps(double duration, double dt) const {
    const double steps = std::ceil(duration / dt);
    const auto limit = static_cast<double>(case_.integration.step_limit);
    if (!(steps <= limit))
      throw InputError(
          "integration.step_limit", std::to_string(case_.integration.step_limit), "",
          "at least the " + detail::to_text(steps) + " steps of this run: " +
              detail::to_text(duration) + " ms in steps of " + detail::to_text(dt) +
              " ms. A higher process.speed or a larger blank.element_size needs fewer; a higher "
              "limit admits the run");
    return static_cast<std::int64_t>(steps);
  }

  std::vector<ElementSample> sample() const {
    std::vector<ElementSample> samples;
    for (const auto& block : integrator_.blocks()) block->sample(integrator_.state(), samples);
    return samples;
  }

  void count_work(std::int64_t steps) {
    WorkCounts& work = result_.work;
    for (const auto& block : integrator_.blocks()) work.gauss_points += steps * block->points();
    PackVisits visits;
    for (const auto& tool : integrator_.tools()) visits += tool->visits();
    work.contact_culled = visits.culled;
    work.contact_flat = visits.flat;
    work.contact_general = visits.general;
  }

  void book(const EnergyLedger& ledger, double stroke) {
    const auto& tools = integrator_.tools();
    const auto term = [&](const char* name) { return ledger.has(name) ? ledger.value(name) : 0.0; };
    LedgerRow row;
    row.time = ledger.time;
    row.stroke = stroke;
    row.punch_work = tools[punch_tool]->work().tool;
    row.holder_work = tools[holder_tool]->work().tool;
    row.yarn = term("yarn");
    row.shear = term("shear");
    row.bending = term("bending");
    row.hourglass = term("hourglass");
    row.contact = term("contact");
    row.kinetic = term("kinetic");
    row.friction = term("friction");
    row.contact_damping = term("contact_damping");
    row.mass_damping = term("mass_damping");
    row.bulk_viscosity = term("bulk_viscosity");
    row.residual = ledger.residual();
    result_.ledger.push_back(row);

    // Below a thousandth of the blank's kinetic energy at punch speed nothing is worth a stop.
    const double floor = 1e-3 * 0.5 * case_.fabric.areal_mass * case_.blank.half_width *
                         case_.blank.half_length * case_.process.speed * case_.process.speed;
    const double scale = std::abs(row.punch_work) + std::abs(row.holder_work) +
                         std::abs(row.yarn + row.shear + row.bending + row.hourglass) +
                         row.kinetic + row.contact + row.friction + row.contact_damping;
    if (!(std::abs(row.residual) <= 0.05 * scale + floor))
      throw RunError("stroke " + detail::to_text(stroke) +
                     " mm: the energy ledger does not close: residual " +
                     detail::to_text(row.residual) + " kN mm of a punch work of " +
                     detail::to_text(row.punch_work) +
                     " kN mm, admissible 5 %. Usual causes: a time step above the critical one, or "
                     "a contact penalty too stiff for it");
  }

  /// Where the centre of an element sits on the flat blank [mm].
  [[nodiscard]] std::array<double, 2> material_centre(int element) const {
    const auto X = mesh_.corners(element);
    return {(X[0].x + X[2].x) / 2, (X[0].y + X[2].y) / 2};
  }

  void check_elements(double stroke) const {
    const std::vector<ElementSample> samples = sample();
    const double longest = case_.fabric.cell.contact_length;
    for (std::size_t e = 0; e < samples.size(); ++e) {
      const ElementSample& s = samples[e];
      std::string what;
      if (!(std::abs(s.shear_angle) < 85 * pi / 180))
        what = "shear angle " + detail::to_text(s.shear_angle * 180 / pi) +
               " deg, admissible below 85: warp and weft fall together";
      for (int i = 0; i < 2; ++i)
        if (!(s.stretch[i] > 0.2 && s.stretch[i] < 1.5))
          what = std::string(i == 0 ? "warp" : "weft") + " stretch " +
                 detail::to_text(s.stretch[i]) + ", admissible 0.2 to 1.5";
      if (!(s.cell_correction < 1e-3 * longest))
        what = "the cell is not in equilibrium: its heights are off by " +
               detail::to_text(s.cell_correction) + " mm, admissible below " +
               detail::to_text(1e-3 * longest) +
               "; fabric.cell_solve = \"converge\" or a smaller "
               "integration.step_factor helps";
      if (what.empty()) continue;
      const auto [x, y] = material_centre(static_cast<int>(e));
      throw RunError("stroke " + detail::to_text(stroke) + " mm, element " + std::to_string(e) +
                     " at material point (" + detail::to_text(x) + ", " + detail::to_text(y) +
                     ") mm: " + what);
    }
  }

  Frame frame(double stroke) const {
    Frame out;
    out.time = integrator_.time();
    out.stroke = stroke;
    const NodalState<R>& state = integrator_.state();
    for (int n = 0; n < state.node_count; ++n) {
      const Vec3<double> x = state.x.get(n);
      out.points.insert(out.points.end(), {x.x, x.y, x.z});
    }
    const std::vector<ElementSample> samples = sample();
    const auto cell_field = [&](const char* name, auto value) {
      Field field{name, 1, {}};
      for (const ElementSample& s : samples) field.values.push_back(value(s));
      out.cell_fields.push_back(std::move(field));
    };
    const auto vector_field = [&](const char* name, auto value) {
      Field field{name, 3, {}};
      for (const ElementSample& s : samples) {
        const Vec3<double> v = value(s);
        field.values.insert(field.values.end(), {v.x, v.y, v.z});
      }
      out.cell_fields.push_back(std::move(field));
    };
    cell_field("shear_angle", [](const auto& s) { return s.shear_angle * 180 / pi; });
    cell_field("yarn_stretch_warp", [](const auto& s) { return s.stretch[0]; });
    cell_field("yarn_stretch_weft", [](const auto& s) { return s.stretch[1]; });
    cell_field("yarn_tension_warp", [](const auto& s) { return s.tension[0]; });
    cell_field("yarn_tension_weft", [](const auto& s) { return s.tension[1]; });
    cell_field("crimp_height_warp", [](const auto& s) { return s.crimp_height[0]; });
    cell_field("crimp_height_weft", [](const auto& s) { return s.crimp_height[1]; });
    cell_field("cell_contact_force", [](const auto& s) { return s.contact_force; });
    cell_field("slack", [](const auto& s) { return s.slack ? 1.0 : 0.0; });
    if (case_.fabric.formulation == CellFormulation::second_order)
      cell_field("fallback", [](const auto& s) { return s.fallback ? 1.0 : 0.0; });
    vector_field("warp_direction", [](const auto& s) { return s.warp; });
    vector_field("weft_direction", [](const auto& s) { return s.weft; });
    out.point_fields.push_back({"shear_angle", 1, node_average(grid_, out.cell_fields[0].values)});
    Field pressure{"contact_pressure", 1, std::vector<double>(state.node_count, 0.0)};
    for (const auto& tool : integrator_.tools()) tool->add_pressure(state, pressure.values);
    out.point_fields.push_back(std::move(pressure));
    return out;
  }

  void measure() {
    const std::vector<double>& points = result_.formed.points;
    const std::vector<ElementSample> samples = sample();
    std::vector<double> shear;
    double slack_area = 0, area = 0;
    for (int e = 0; e < mesh_.element_count(); ++e) {
      const ElementSample& s = samples[e];
      shear.push_back(s.shear_angle);
      area += mesh_.area(e);
      if (s.slack) slack_area += mesh_.area(e);
      for (double tension : s.tension)
        result_.largest_yarn_tension = std::max(result_.largest_yarn_tension, tension);
      if (std::abs(s.shear_angle) * 180 / pi > std::abs(result_.maximum_shear_deg)) {
        result_.maximum_shear_deg = s.shear_angle * 180 / pi;
        result_.maximum_shear_material = material_centre(e);
      }
    }
    result_.slack_fraction = slack_area / area;
    result_.shear_points = shear_points(grid_, points, shear);
    result_.outline = outline(grid_, points);
    result_.draw_in_x = grid_.half_width - points[3 * grid_.node(grid_.nx, 0)];
    result_.draw_in_y = grid_.half_length - points[3 * grid_.node(0, grid_.ny) + 1];
    const int corner = grid_.node(grid_.nx, grid_.ny);
    result_.corner = {points[3 * corner], points[3 * corner + 1]};

    const LedgerRow& end = result_.ledger.back();
    double worst = 0;
    for (const LedgerRow& row : result_.ledger) {
      worst = std::abs(row.residual) > std::abs(worst) ? row.residual : worst;
      if (row.stroke <= 0.95 * case_.process.stroke && row.punch_work != 0)
        result_.kinetic_over_punch_work_at_95 = row.kinetic / row.punch_work;
    }
    result_.residual_over_punch_work = worst / end.punch_work;
    result_.kinetic_over_internal_at_end =
        end.kinetic / (end.yarn + end.shear + end.bending + end.hourglass);
  }

  DrapeCase case_;
  QuarterModel<R> built_;
  const QuarterGrid& grid_ = built_.grid();
  const Mesh<4>& mesh_ = built_.mesh();
  const PunchStroke& punch_ = built_.punch();
  CentralDifference<T> integrator_;
  DrapeResult result_;
};

}  // namespace

DrapeResult run(const DrapeCase& drape_case, const Progress& progress, const FrameSink& frames) {
  validate(drape_case);
  const YarnParameters<double>&warp = drape_case.fabric.cell.warp,
        &weft = drape_case.fabric.cell.weft;
  const bool balanced =
      warp.youngs_modulus == weft.youngs_modulus && warp.cross_section == weft.cross_section &&
      warp.second_moment_of_area == weft.second_moment_of_area && warp.length == weft.length &&
      drape_case.fabric.cell.warp_height_fraction == 0.5 &&
      drape_case.fabric.warp_bending_stiffness == drape_case.fabric.weft_bending_stiffness;
  if (drape_case.blank.layout != 0 && !balanced)
    throw InputError("blank.layout", detail::to_text(drape_case.blank.layout), "deg",
                     "0 for a fabric whose warp and weft differ: a quarter model at 45 deg mirrors "
                     "warp into weft");
  progress.announce(fmt::format("building the model: {} elements",
                                quarter_grid(drape_case.blank).element_count()));
  if (drape_case.integration.precision == Precision::float_)
    return QuarterDrape<float>(drape_case).run(progress, frames);
  return QuarterDrape<double>(drape_case).run(progress, frames);
}

}  // namespace crossbeam::drape
