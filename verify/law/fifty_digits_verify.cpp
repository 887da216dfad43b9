// Kinematics and membrane law in fifty digits against double.

#include "support/fifty_digits.hpp"

#include "crossbeam/kinematics/convected.hpp"
#include "law/laws.hpp"
#include "support/claim.hpp"

#include <Eigen/Geometry>

#include <doctest/doctest.h>

namespace {

using crossbeam::Base;
using crossbeam::Matrix2;
using verify::Fifty;
using verify::roundings;

/// The same chain in any scalar: from bases and increments to strain and shear angle.
template <class T>
struct Kinematics {
  Matrix2<T> E;
  crossbeam::FibreStrain<T> beta;
  T elongation1, elongation2, gamma;

  Kinematics(const Base<T>& reference, const Base<T>& increment, const T& alpha, const T& delta) {
    using namespace crossbeam;
    const FibreAngle<T> angle(delta);
    const Matrix2<T> d = cartesian_from_convected(reference, alpha);
    E = to_cartesian<T>(convected_strain_from_increment(increment, reference), d);
    beta = fibre_strain<T>(E, fibre_from_cartesian(angle));
    const T lambda1 = stretch(beta.b11), lambda2 = stretch(beta.b22);
    elongation1 = relative_elongation(beta.b11, lambda1);
    elongation2 = relative_elongation(beta.b22, lambda2);
    gamma = shear_angle(fibre_cosine(beta, lambda1, lambda2, angle.cosine), angle);
  }
};

}  // namespace

TEST_SUITE_BEGIN("kinematics");

TEST_CASE("V-KIN-08 strains and shear angle in double are those of fifty digits, large and small") {
  VERIFY_RANDOM(random, 1008);
  verify::Worst strains, elongations, angles;
  for (int sample = 0; sample < 3000; ++sample) {
    Base<double> reference, increment;
    do {
      reference.col(0) = random.vector(5);
      reference.col(1) = random.vector(5);
    } while (reference.col(0).cross(reference.col(1)).norm() <
             0.3 * reference.col(0).norm() * reference.col(1).norm());
    const double size = random.log_uniform(1e-8, 0.1);
    Eigen::Matrix3d map;
    for (int i = 0; i < 3; ++i) map.col(i) = random.vector(size);
    increment = map * reference;
    const double alpha = random.uniform(-3, 3), delta = random.uniform(0.6, 2.5);
    const Kinematics<double> a(reference, increment, alpha, delta);
    const Kinematics<Fifty> b(reference.cast<Fifty>(), increment.cast<Fifty>(), alpha, delta);
    const Fifty scale = b.E.cwiseAbs().maxCoeff();
    REQUIRE(scale > size * 1e-3);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) strains.see(roundings(a.E(i, j), b.E(i, j), scale), "E", size);
    strains.see(roundings(a.beta.b11, b.beta.b11, scale), "b11", size);
    strains.see(roundings(a.beta.b22, b.beta.b22, scale), "b22", size);
    strains.see(roundings(a.beta.b12, b.beta.b12, scale), "b12", size);
    elongations.see(roundings(a.elongation1, b.elongation1, scale), size);
    elongations.see(roundings(a.elongation2, b.elongation2, scale), size);
    angles.see(roundings(a.gamma, b.gamma, Fifty(1)), size, delta);
  }
  // Bases as flat as 17 deg: sixteen roundings over the squared sine, as in V-KIN-01; the angle has
  // one or two of pi/2 and of an arcsine. At a strain of 1e-8 as at 0.1: nothing cancels.
  strains.claim("V-KIN-08", 180, "E and beta, in roundings of the largest strain");
  elongations.claim("V-KIN-08", 180, "elongations, in roundings of the largest strain");
  angles.claim("V-KIN-08", 8, "shear angle, in roundings of 1 rad");
}

TEST_SUITE_END();
TEST_SUITE_BEGIN("law");

TEST_CASE("V-LAW-21 stress, tangent and energy in double are those of fifty digits") {
  VERIFY_RANDOM(random, 3021);
  verify::Worst stress, tangent, energy;
  for (const int degrees : {60, 90, 120}) {
    // The same layers in both scalars, one after the other: the visitor of the second needs the
    // answers of the first.
    struct Sample {
      Matrix2<double> E;
      crossbeam::MembraneResponse<double> r;
      double stiffness;
    };
    std::vector<std::vector<Sample>> in_double;
    verify::for_each_shear<double>(degrees, [&](const std::string&, const auto& shear) {
      const auto law = verify::woven(crossbeam::CellParameters<double>{}, shear, degrees);
      std::vector<Sample> samples;
      for (int k = 0; k < 100; ++k) {
        const Matrix2<double> E = verify::random_strain(random, degrees, 1e-6);
        samples.push_back({E, crossbeam::membrane_response(law, E, crossbeam::Tangent::yes),
                           law.stiffness_bound()});
        REQUIRE(samples.back().r.status == crossbeam::CellStatus::converged);
      }
      in_double.push_back(samples);
    });
    std::size_t layer = 0;
    verify::for_each_shear<Fifty>(degrees, [&](const std::string& name, const auto& shear) {
      const auto law = verify::woven(crossbeam::CellParameters<Fifty>{}, shear, degrees);
      for (const Sample& a : in_double.at(layer++)) {
        const Matrix2<Fifty> E = a.E.cast<Fifty>();
        const auto b = crossbeam::membrane_response(law, E, crossbeam::Tangent::yes);
        REQUIRE(b.status == crossbeam::CellStatus::converged);
        const Fifty strain = E.cwiseAbs().maxCoeff();
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            stress.see(roundings(a.r.S(i, j), b.S(i, j), a.stiffness * strain), name, degrees);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            tangent.see(roundings(a.r.dS_dE(i, j), b.dS_dE(i, j), a.stiffness), name, degrees);
        energy.see(roundings(a.r.energy, b.energy, a.stiffness * strain * strain), name, degrees);
      }
    });
    REQUIRE(layer == in_double.size());
  }
  // Two products with c on each side of numbers that are right to 3 (forces) and 8 (tangent)
  // roundings (V-CELL-29); the energy of a sheared state is small beside its scale.
  stress.claim("V-LAW-21", 20, "S, in roundings of stiffness times strain");
  tangent.claim("V-LAW-21", 30, "dS/dE, in roundings of the stiffness");
  energy.claim("V-LAW-21", 20, "energy, in roundings of stiffness times strain squared");
}

TEST_SUITE_END();
