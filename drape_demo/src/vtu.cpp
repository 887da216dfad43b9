#include "vtu.hpp"

#include "text_file.hpp"

#include "crossbeam/base/error.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace crossbeam::drape {
namespace {

constexpr const char* byte_order =
    std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

/// The binary part of the file: arrays one after the other, each behind its length.
class AppendedData {
 public:
  /// Adds an array and returns the XML element that refers to it.
  template <class T>
  std::string add(std::string_view name, const char* type, int components,
                  const std::vector<T>& values) {
    const std::size_t offset = bytes_.size();
    const std::uint64_t length = values.size() * sizeof(T);
    bytes_.resize(offset + sizeof(length) + length);
    std::memcpy(bytes_.data() + offset, &length, sizeof(length));
    if (length > 0) std::memcpy(bytes_.data() + offset + sizeof(length), values.data(), length);
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        type, name, components, offset);
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string field_elements(AppendedData& data, const std::vector<Field>& fields,
                           std::size_t count) {
  std::string xml;
  for (const Field& field : fields) {
    CROSSBEAM_EXPECTS(field.values.size() == count * static_cast<std::size_t>(field.components));
    xml += data.add(field.name, "Float64", field.components, field.values);
  }
  return xml;
}

}  // namespace

void write_vtu(const std::filesystem::path& file, const std::vector<std::array<int, 4>>& quads,
               const Frame& frame) {
  constexpr std::uint8_t vtk_quad = 9;
  const std::size_t nodes = frame.points.size() / 3, cells = quads.size();
  CROSSBEAM_EXPECTS(frame.points.size() == 3 * nodes);

  std::vector<std::int64_t> connectivity, offsets;
  for (const auto& quad : quads) {
    connectivity.insert(connectivity.end(), quad.begin(), quad.end());
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }
  const std::vector<std::uint8_t> types(cells, vtk_quad);

  AppendedData data;
  const std::string points = data.add("Points", "Float64", 3, frame.points);
  const std::string topology = data.add("connectivity", "Int64", 1, connectivity) +
                               data.add("offsets", "Int64", 1, offsets) +
                               data.add("types", "UInt8", 1, types);
  const std::string point_data = field_elements(data, frame.point_fields, nodes);
  const std::string cell_data = field_elements(data, frame.cell_fields, cells);

  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n"
      "<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
      "<PointData>\n{}</PointData>\n"
      "<CellData>\n{}</CellData>\n"
      "<Points>\n{}</Points>\n"
      "<Cells>\n{}</Cells>\n"
      "</Piece>\n"
      "</UnstructuredGrid>\n"
      "<AppendedData encoding=\"raw\">\n_",
      byte_order, nodes, cells, point_data, cell_data, points, topology);
  xml += data.bytes();
  xml += "\n</AppendedData>\n</VTKFile>\n";
  write_file(file, xml);
}

void write_pvd(const std::filesystem::path& file, const std::vector<FrameFile>& frames) {
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"{}\">\n<Collection>\n",
      byte_order);
  for (const FrameFile& frame : frames)
    xml += fmt::format("<DataSet timestep=\"{:.9g}\" part=\"0\" file=\"{}\"/>\n", frame.time,
                       frame.name);
  xml += "</Collection>\n</VTKFile>\n";
  write_file(file, xml);
}

}  // namespace crossbeam::drape
