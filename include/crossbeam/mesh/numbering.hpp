#pragma once
/// @file
/// New numbers for an unstructured mesh: nodes level by level, elements along the nodes, so that a
/// sweep walks through memory and levels can be shared out. Theory: docs/theory/sweep.md,
/// "Numbering".
///
/// Every permutation goes from new to old: permutation[new number] = old number.

#include "crossbeam/mesh/levels.hpp"

namespace crossbeam {

struct Numbering {
  std::vector<int> node;         ///< new to old
  std::vector<int> element;      ///< new to old
  std::vector<int> level_start;  ///< first new node of each level; the node count at the end
};

/// Nodes level by level; elements by their lowest node, then the next lowest and so on. Elements
/// with their lowest node in one level are consecutive.
template <int Corners>
Numbering number_by_levels(const Mesh<Corners>& mesh) {
  Levels levels = node_levels(mesh);
  const std::vector<int> new_node = inverse(levels.node);
  std::vector<std::pair<std::array<int, Corners>, int>> order;
  for (const auto& element : mesh.elements) {
    order.push_back({element, static_cast<int>(order.size())});
    auto& key = order.back().first;
    for (int& n : key) n = new_node[n];
    std::sort(key.begin(), key.end());
  }
  std::sort(order.begin(), order.end());
  Numbering out{std::move(levels.node), {}, std::move(levels.start)};
  for (const auto& entry : order) out.element.push_back(entry.second);
  return out;
}

/// Data of nodes or elements in the new order. What lies behind the permutation (padding) stays.
template <class T, class Allocator>
std::vector<T, Allocator> to_new(const std::vector<T, Allocator>& old_data,
                                 const std::vector<int>& permutation) {
  auto out = old_data;
  for (std::size_t i = 0; i < permutation.size(); ++i) out[i] = old_data[permutation[i]];
  return out;
}
template <class R>
NodeVectors<R> to_new(NodeVectors<R> data, const std::vector<int>& permutation) {
  for (auto* component : {&data.x, &data.y, &data.z}) *component = to_new(*component, permutation);
  return data;
}

/// Data of nodes or elements back in the old order.
template <class Data>
Data to_old(const Data& new_data, const std::vector<int>& permutation) {
  return to_new(new_data, inverse(permutation));
}

/// The same mesh under new numbers; the order of an element's corners and every bit of it stay.
template <int Corners>
Mesh<Corners> renumbered(const Mesh<Corners>& mesh, const Numbering& numbering) {
  Mesh<Corners> out = mesh;  // checked already, and its fibres would not survive a second rounding
  const std::vector<int> new_node = inverse(numbering.node);
  out.nodes = to_new(mesh.nodes, numbering.node);
  out.elements = to_new(mesh.elements, numbering.element);
  out.fibres = to_new(mesh.fibres, numbering.element);
  for (auto& element : out.elements)
    for (int& n : element) n = new_node[n];
  return out;
}

}  // namespace crossbeam
