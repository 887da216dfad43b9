#pragma once
/// @file
/// The 20 states of verify/reference/cell_reference.json: a separate implementation in 60-digit
/// arithmetic (energies minimised from scratch, stresses by numerical differentiation of the
/// minimised energy), printed with 42 digits. Numbers below 1e-40 mean zero.

#include "crossbeam/base/linalg.hpp"
#include "crossbeam/cell/parameters.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace verify {

using Json = nlohmann::json;

template <class R>
R number(const Json& text) {
  return static_cast<R>(std::strtold(text.get<std::string>().c_str(), nullptr));
}
template <class R>
crossbeam::Vector3<R> vector3(const Json& a) {
  return {number<R>(a[0]), number<R>(a[1]), number<R>(a[2])};
}
template <class R>
crossbeam::Matrix2<R> matrix2(const Json& a) {
  crossbeam::Matrix2<R> m;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) m(i, j) = number<R>(a[i][j]);
  return m;
}
template <class R>
crossbeam::Matrix3<R> matrix3(const Json& a) {
  crossbeam::Matrix3<R> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = number<R>(a[i][j]);
  return m;
}

inline const std::vector<Json>& reference_states() {
  static const std::vector<Json> states = [] {
    const std::string path =
        std::string(CROSSBEAM_SOURCE_DIR) + "/verify/reference/cell_reference.json";
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path);
    return Json::parse(file).at("states").get<std::vector<Json>>();
  }();
  return states;
}

template <class R>
crossbeam::CellParameters<R> reference_parameters(const Json& state) {
  const Json& p = state.at("params");
  crossbeam::CellParameters<R> c;
  c.warp = {number<R>(p["E1"]), number<R>(p["A1"]), number<R>(p["I1"]), number<R>(p["L1"])};
  c.weft = {number<R>(p["E2"]), number<R>(p["A2"]), number<R>(p["I2"]), number<R>(p["L2"])};
  c.contact_modulus = number<R>(p["E3"]);
  c.contact_area = number<R>(p["A3"]);
  c.contact_length = number<R>(p["L3"]);
  c.warp_height_fraction = number<R>(p["chi"]);
  c.bending_boundary_factor = number<R>(p["kbc"]);
  c.symmetry = static_cast<int>(number<R>(p["nsym"]));
  return c;
}

/// The angle fields are whole degrees.
template <class R>
R reference_angle(const Json& state, const char* field) {
  return number<R>(state.at(field)) * (crossbeam::detail::half_pi<R>() / R(90));
}

template <class R>
crossbeam::Base<R> reference_base(const Json& state, const char* first, const char* second) {
  crossbeam::Base<R> base;
  base.col(0) = vector3<R>(state.at(first));
  base.col(1) = vector3<R>(state.at(second));
  return base;
}

}  // namespace verify
