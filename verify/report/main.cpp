/// @file
/// crossbeam-verify-report: merges the claims table, what the tests measured and which tests failed
/// into report.json and report.md. A plain program on purpose: the tests know nothing of it.
///
///   crossbeam-verify-report <claims table .md> <measured .jsonl> <ctest JUnit .xml> <output folder>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string trimmed(std::string s) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!s.empty() && blank(s.back())) s.pop_back();
  s.erase(0, s.find_first_not_of(" \t\r") == std::string::npos ? s.size()
                                                                 : s.find_first_not_of(" \t\r"));
  return s;
}

struct Claim {
  std::string id, statement, source, tolerance, area;
  Json measured = Json::array();
  int tests = 0, failed_tests = 0;

  [[nodiscard]] bool pass() const {
    bool all = tests > 0 && failed_tests == 0;
    for (const Json& m : measured) all = all && m.at("pass").get<bool>();
    return all;
  }
};

/// Rows `| V-XXX-NN | statement | test file | source | tolerance |` under their `## ` headings.
std::vector<Claim> claims_of(const std::string& table) {
  std::vector<Claim> claims;
  std::istringstream lines(table);
  std::string line, area;
  while (std::getline(lines, line)) {
    if (line.rfind("## ", 0) == 0) area = trimmed(line.substr(3));
    if (line.rfind("| V-", 0) != 0) continue;
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(trimmed(cell));
    if (cells.size() < 5) throw std::runtime_error("claims table: five columns wanted in " + line);
    claims.push_back({cells[0], cells[1], cells[3], cells[4], area});
  }
  return claims;
}

/// Counts the tests that carry each claim and those that failed.
void count_tests(const std::string& junit, std::map<std::string, Claim*>& by_id) {
  const std::regex test("<testcase name=\"[^\"]*?(V-[A-Z0-9]+-[0-9]+)[^\"]*\"[^>]*status=\"(\\w+)\"");
  for (auto i = std::sregex_iterator(junit.begin(), junit.end(), test);
       i != std::sregex_iterator(); ++i) {
    const auto claim = by_id.find((*i)[1]);
    if (claim == by_id.end()) continue;
    ++claim->second->tests;
    if ((*i)[2] != "run") ++claim->second->failed_tests;
  }
}

std::string number(const Json& value) {
  if (!value.is_number()) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value.get<double>());
  return text;
}

std::string page(const std::vector<Claim>& claims) {
  const auto held = std::count_if(claims.begin(), claims.end(), [](const Claim& c) {
    return c.pass();
  });
  std::ostringstream out;
  out << "# Verification report\n\n"
      << held << " of " << claims.size() << " claims hold.\n";
  for (const Claim& c : claims)
    if (!c.pass()) out << "\n**NOT HELD: " << c.id << "** " << c.statement << "\n";
  std::string area;
  for (const Claim& c : claims) {
    if (c.area != area) out << "\n## " << c.area << "\n";
    area = c.area;
    out << "\n### " << c.id << (c.pass() ? "" : " - NOT HELD") << "\n\n"
        << c.statement << "\n\nIndependent source: " << c.source << ". Tolerance: " << c.tolerance
        << ".\nRepeat with `ctest --test-dir build/verify -R " << c.id << "`.\n";
    if (c.measured.empty()) continue;
    out << "\n| measured | | tolerance | of what | |\n| ---: | --- | ---: | --- | --- |\n";
    for (const Json& m : c.measured)
      out << "| " << number(m.at("measured")) << " | "
          << (m.at("bound") == "upper" ? "<=" : ">=") << " | " << number(m.at("tolerance")) << " | "
          << m.at("note").get<std::string>() << " | "
          << (m.at("pass").get<bool>() ? "holds" : "FAILS") << " |\n";
  }
  return out.str();
}

Json document(const std::vector<Claim>& claims) {
  Json out;
  out["claims"] = Json::array();
  for (const Claim& c : claims) {
    // One number per claim for those who want one: the comparison closest to its bound.
    const Json* tightest = nullptr;
    double least = 0;
    for (const Json& m : c.measured) {
      if (!m.at("measured").is_number() || !m.at("tolerance").is_number()) continue;
      const double value = m.at("measured"), tolerance = m.at("tolerance");
      const double used = m.at("bound") == "upper" ? (tolerance != 0 ? value / tolerance : value)
                                                   : (value != 0 ? tolerance / value : 1e300);
      if (!tightest || used > least) {
        tightest = &m;
        least = used;
      }
    }
    Json row;
    row["id"] = c.id;
    row["area"] = c.area;
    row["statement"] = c.statement;
    row["independent_source"] = c.source;
    row["tolerance_reason"] = c.tolerance;
    row["measured"] = tightest ? tightest->at("measured") : Json();
    row["tolerance"] = tightest ? tightest->at("tolerance") : Json();
    row["pass"] = c.pass();
    row["tests"] = c.tests;
    row["comparisons"] = c.measured;
    out["claims"].push_back(row);
  }
  return out;
}

/// Nobody finds half a report: the text goes to a neighbour that is then renamed.
void write(const fs::path& file, const std::string& text) {
  fs::path temporary = file;
  temporary += ".partial";
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + temporary.string());
  fs::rename(temporary, file);
}

int report(const fs::path& table, const fs::path& measured, const fs::path& junit,
           const fs::path& folder) {
  std::vector<Claim> claims = claims_of(read(table));
  std::map<std::string, Claim*> by_id;
  for (Claim& c : claims) by_id[c.id] = &c;
  count_tests(read(junit), by_id);
  std::istringstream lines(fs::exists(measured) ? read(measured) : std::string());
  for (std::string line; std::getline(lines, line);) {
    Json m = Json::parse(line);
    if (m.at("kind") != "measurement") continue;
    m.erase("kind");
    const auto claim = by_id.find(m.at("id"));
    if (claim == by_id.end()) throw std::runtime_error("no such claim: " + line);
    m.erase("id");
    claim->second->measured.push_back(m);
  }
  write(folder / "report.json", document(claims).dump(1) + "\n");
  write(folder / "report.md", page(claims));
  const auto held = std::count_if(claims.begin(), claims.end(), [](const Claim& c) {
    return c.pass();
  });
  std::printf("%ld of %zu claims hold; report.md and report.json in %s\n",
              static_cast<long>(held), claims.size(), folder.string().c_str());
  return held == static_cast<long>(claims.size()) ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    if (count != 5)
      throw std::runtime_error(
          "wanted: <claims table .md> <measured .jsonl> <ctest JUnit .xml> <output folder>");
    return report(arguments[1], arguments[2], arguments[3], arguments[4]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "crossbeam-verify-report: %s\n", error.what());
    return 2;
  }
}
