#pragma once
/// @file
/// Levels of a mesh: its nodes in a sequence of sets such that the nodes of an element stand in one
/// of them or in two neighbouring ones. A breadth-first search finds them, or they are read off the
/// numbering that a mesh has. Theory: docs/theory/sweep.md, "Numbering".

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/mesh/mesh.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace crossbeam {

/// Levels of nodes: level l holds node[start[l]] to node[start[l + 1] - 1].
struct Levels {
  std::vector<int> node;      ///< numbers in the mesh, level after level
  std::vector<int> start{0};  ///< first place of each level; the node count at the end

  [[nodiscard]] int count() const { return static_cast<int>(start.size()) - 1; }
  [[nodiscard]] int widest() const {
    int most = 0;
    for (int l = 0; l < count(); ++l) most = maximum(most, start[l + 1] - start[l]);
    return most;
  }
  [[nodiscard]] std::vector<int> last() const {
    return {node.begin() + start[count() - 1], node.end()};
  }
};

namespace detail {

/// Breadth-first searches over nodes that share an element. An element has handed on all its nodes
/// as soon as one of them has been visited, so that a search costs the number of corners.
template <int Corners>
class LevelSearch {
 public:
  LevelSearch(int node_count, const std::vector<std::array<int, Corners>>& elements)
      : elements_(elements),
        first_(node_count + 1, 0),
        of_node_(elements.size() * Corners),
        node_seen_(node_count, 0),
        element_seen_(elements.size(), 0),
        in_set_(node_count, false) {
    for (const auto& element : elements_)
      for (int n : element) ++first_[n];
    for (int n = 0; n < node_count; ++n) first_[n + 1] += first_[n];
    for (std::size_t e = elements_.size(); e-- > 0;)
      for (int n : elements_[e]) of_node_[--first_[n]] = static_cast<int>(e);
  }

  /// Whether a search has come by.
  [[nodiscard]] bool seen(int node) const { return node_seen_[node] > 0; }

  Levels search(std::vector<int> roots) {
    return search(std::move(roots), [](int) { return true; });
  }

  /// All that is connected with a node, in the narrowest levels tried: from a pseudo-peripheral
  /// node (George and Liu), from all nodes of the farthest level, and from half of those.
  Levels part(int any_node) {
    Levels from_node = search({any_node});
    // Each turn but the last lengthens the levels; in practice two to four. The bound keeps the
    // cost in proportion to the mesh whatever the mesh.
    for (int turn = 0, depth = 0; turn < 8 && from_node.count() > depth; ++turn) {
      depth = from_node.count();
      const std::vector<int> farthest = from_node.last();
      from_node = search({*std::min_element(farthest.begin(), farthest.end(), fewer_elements())});
    }
    // The far side of a strip is a whole row, that of a square two sides.
    std::vector<int> farthest = in_line(from_node.last());
    Levels best = std::move(from_node);
    for (std::size_t size : {farthest.size(), (farthest.size() + 1) / 2}) {
      farthest.resize(size);
      Levels from_set = search(farthest);
      if (from_set.widest() < best.widest()) best = std::move(from_set);
    }
    return best;
  }

 private:
  /// The order of Cuthill and McKee: each node hands on its unvisited neighbours, those with the
  /// fewest elements first.
  template <class Inside>
  Levels search(std::vector<int> roots, const Inside& inside) {
    Levels out;
    std::vector<int>& node = out.node = std::move(roots);
    ++searches_;
    for (int n : node) node_seen_[n] = searches_;
    for (std::size_t at = 0; at < node.size();) {
      out.start.push_back(static_cast<int>(node.size()));
      for (const std::size_t end = node.size(); at < end; ++at) {
        const std::size_t first = node.size();
        for (int i = first_[node[at]]; i < first_[node[at] + 1]; ++i) {
          if (std::exchange(element_seen_[of_node_[i]], searches_) == searches_) continue;
          for (int n : elements_[of_node_[i]])
            if (node_seen_[n] != searches_ && inside(n)) {
              node_seen_[n] = searches_;
              node.push_back(n);
            }
        }
        std::sort(node.begin() + static_cast<std::ptrdiff_t>(first), node.end(), fewer_elements());
      }
    }
    return out;
  }

  /// Sorts a set of nodes along itself: from one end of each of its connected pieces to the other.
  std::vector<int> in_line(const std::vector<int>& set) {
    const auto inside = [this](int n) { return in_set_[n]; };
    for (int n : set) in_set_[n] = true;
    std::vector<int> out;
    for (int n : set) {
      if (!in_set_[n]) continue;
      const int end = search({n}, inside).node.back();
      for (int m : search({end}, inside).node) {
        out.push_back(m);
        in_set_[m] = false;
      }
    }
    return out;
  }

  [[nodiscard]] auto fewer_elements() const {
    return [this](int a, int b) {
      return std::pair(first_[a + 1] - first_[a], a) < std::pair(first_[b + 1] - first_[b], b);
    };
  }

  const std::vector<std::array<int, Corners>>& elements_;
  std::vector<int> first_, of_node_;  // elements of node n: of_node_[first_[n]] to [first_[n + 1]]
  std::vector<int> node_seen_, element_seen_;  // number of the last search that came by
  std::vector<bool> in_set_;
  int searches_ = 0;
};

}  // namespace detail

/// new to old from old to new, and back
inline std::vector<int> inverse(const std::vector<int>& permutation) {
  std::vector<int> out(permutation.size());
  for (std::size_t i = 0; i < permutation.size(); ++i) out[permutation[i]] = static_cast<int>(i);
  return out;
}

/// Levels of all nodes, one connected part after the other. A node without element is a level.
template <int Corners>
Levels node_levels(const Mesh<Corners>& mesh) {
  // One walk over the mesh as it is brings neighbours together in memory; the searches that follow
  // are several times as fast then.
  std::vector<int> walked;
  detail::LevelSearch<Corners> walk(mesh.node_count, mesh.elements);
  for (int n = 0; n < mesh.node_count; ++n)
    if (!walk.seen(n))
      for (int m : walk.search({n}).node) walked.push_back(m);
  const std::vector<int> new_node = inverse(walked);
  auto elements = mesh.elements;
  for (auto& element : elements)
    for (int& n : element) n = new_node[n];
  std::sort(elements.begin(), elements.end());
  detail::LevelSearch<Corners> search(mesh.node_count, elements);
  Levels out;
  for (int n = 0; n < mesh.node_count; ++n) {
    if (search.seen(n)) continue;
    const Levels part = search.part(n);
    const int before = static_cast<int>(out.node.size());
    for (int m : part.node) out.node.push_back(walked[m]);
    for (int l = 1; l <= part.count(); ++l) out.start.push_back(before + part.start[l]);
  }
  return out;
}

/// Levels of a mesh without numbering it anew: blocks of consecutive nodes such that every element
/// stands in one block or in two neighbouring ones. A block ends at the highest node that shares an
/// element with the block before; the end of the first is the one with the narrowest widest block.
/// A numbering without order gives few blocks, at worst one.
/// @return first node of each block; the node count at the end
template <int Corners>
std::vector<int> levels_in_place(const Mesh<Corners>& mesh) {
  const int count = mesh.node_count;
  std::vector<int> reach(count);  // highest node that shares an element with one of 0 to n
  for (int n = 0; n < count; ++n) reach[n] = n;
  for (const auto& element : mesh.elements) {
    const auto [low, high] = std::minmax_element(element.begin(), element.end());
    reach[*low] = maximum(reach[*low], *high);
  }
  for (int n = 1; n < count; ++n) reach[n] = maximum(reach[n], reach[n - 1]);
  std::vector<int> widest(count, 0);  // of the blocks that follow one that ends at n
  for (int n = count - 1; n >= 0; --n)
    if (reach[n] > n) widest[n] = maximum(reach[n] - n, widest[reach[n]]);
  std::vector<int> start{0};
  while (start.back() < count) {  // no element crosses to the nodes from here on: a new first block
    const int begin = start.back();
    int end = begin;
    // Stops where no element crosses, at the latest: one block is then as narrow as what follows.
    for (int n = begin, least = count + 1; n - begin + 1 < least; ++n) {
      const int width = maximum(n - begin + 1, widest[n]);
      if (width < least) {
        least = width;
        end = n;
      }
    }
    start.push_back(end + 1);
    for (; reach[end] > end; end = reach[end]) start.push_back(reach[end] + 1);
  }
  return start;
}

}  // namespace crossbeam
