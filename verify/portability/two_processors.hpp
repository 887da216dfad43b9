// What the two halves of two_processors exchange: public structs by reference, and their sizes.
#pragma once

#include "crossbeam/crossbeam.hpp"

#include <array>
#include <cstddef>

namespace two_processors {

using namespace crossbeam;

inline auto law() {
  const auto angle = FibreAngle<double>::right();
  return WovenMembrane(CrossedBeamCell<double>(CellParameters<double>{}),
                       ConstantShear<double>(1e-3, angle), angle);
}

/// A response with a neighbour that nobody may write to.
struct Guarded {
  MembraneResponse<double> response;
  double after = 1;
};

/// Sizes, alignments and offsets of what is public and no pack. (Static: of an inline function the
/// linker would keep one for both files.)
static std::array<std::size_t, 20> layout() {
  return {sizeof(Vector2<double>),
          alignof(Vector2<double>),
          sizeof(Matrix2<double>),
          alignof(Matrix2<double>),
          alignof(Matrix2<float>),
          alignof(Matrix3<double>),
          alignof(Base<double>),
          sizeof(MembraneResponse<double>),
          alignof(MembraneResponse<double>),
          sizeof(MembraneResponse<float>),
          offsetof(MembraneResponse<double>, dS_dE),
          sizeof(Guarded),
          sizeof(CellParameters<double>),
          sizeof(CrossedBeamCell<double>),
          sizeof(decltype(law())),
          sizeof(Mesh<4>),
          sizeof(NodalState<double>),
          sizeof(NodalState<float>),
          sizeof(ContactParameters),
          sizeof(HeightTable<float>)};
}

}  // namespace two_processors

// The half that is compiled for another processor.
std::array<std::size_t, 20> layout_there();
void respond_there(const crossbeam::Matrix2<double>& strain, two_processors::Guarded& out);
