#include "two_processors.hpp"

std::array<std::size_t, 20> layout_there() { return two_processors::layout(); }

void respond_there(const crossbeam::Matrix2<double>& strain, two_processors::Guarded& out) {
  out.response = membrane_response(two_processors::law(), strain, crossbeam::Tangent::yes);
}
