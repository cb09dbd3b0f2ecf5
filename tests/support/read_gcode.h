#pragma once

#include <cctype>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry.h"

/// A reader of G-code that shares nothing with the writer: moves as a machine would make them.
namespace lamella::test {

struct GcodeMove {
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::Zero();
  double filament = 0.0;  ///< mm, pushed out (or drawn back) during the move
  int tool = -1;
  std::string material;  ///< of the comment before it
  int layer = -1;
  bool is_travel = false;     ///< G0
  double acceleration = 0.0;  ///< mm/s^2 that the machine was told last for moves of this kind; 0: none

  [[nodiscard]] bool moves() const { return (to - from).head<2>().norm() > 0.0; }
};

struct GcodeFile {
  std::vector<GcodeMove> moves;
  std::vector<std::pair<int, int>> tools;  ///< layer and tool of each change
  std::vector<std::string> pauses;
  std::map<int, double> temperature;  ///< last set above 0, by tool
};

class GcodeReader {
 public:
  [[nodiscard]] GcodeFile read(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) read_line(line);
    return std::move(file_);
  }

 private:
  void read_line(const std::string& line) {
    const std::string material = "; material: ";
    if (line.starts_with(";LAYER:")) layer_ = std::stoi(line.substr(7));
    if (line.starts_with(material)) material_ = line.substr(material.size());
    std::istringstream words(line.substr(0, line.find(';')));
    std::string command;
    if (!(words >> command)) return;
    std::map<char, double> values;
    std::string word;
    std::map<std::string, std::string> named;
    while (words >> word) {
      if (const auto equals = word.find('='); equals != std::string::npos) {
        named[word.substr(0, equals)] = word.substr(equals + 1);
      } else {
        values[word[0]] = std::strtod(word.c_str() + 1, nullptr);
      }
    }
    obey(command, values, named, line);
  }

  void obey(const std::string& command, const std::map<char, double>& values,
            const std::map<std::string, std::string>& named, const std::string& line) {
    if (command == "G0" || command == "G1") return move(values, command == "G0");
    if (command == "M204") {
      track_acceleration_ = values.at('P');
      travel_acceleration_ = values.at('T');
    }
    if (command == "SET_VELOCITY_LIMIT") track_acceleration_ = travel_acceleration_ = std::stod(named.at("ACCEL"));
    if (command == "M82") is_relative_ = false;
    if (command == "M83") is_relative_ = true;
    if (command == "G92" && values.contains('E')) filament_ = values.at('E');
    if (command == "G28") at_ = Vec3::Zero();
    if (command[0] == 'T' && command.size() > 1 && std::isdigit(command[1]) != 0) choose(std::stoi(command.substr(1)));
    if (command == "ACTIVATE_EXTRUDER") choose(number_of(named.at("EXTRUDER")));
    if (command == "M109") file_.temperature[static_cast<int>(values.at('T'))] = values.at('S');
    if (command == "G10" && values.at('S') > 0.0) file_.temperature[static_cast<int>(values.at('P'))] = values.at('S');
    if (command == "SET_HEATER_TEMPERATURE" && named.at("HEATER").starts_with("extruder")) {
      const double target = std::stod(named.at("TARGET"));
      if (target > 0.0) file_.temperature[number_of(named.at("HEATER"))] = target;
    }
    if (command == "M0" || command == "M291" || command == "PAUSE") file_.pauses.push_back(line);
  }

  static int number_of(const std::string& extruder) {
    return extruder == "extruder" ? 0 : std::stoi(extruder.substr(8));
  }

  void choose(int tool) {
    tool_ = tool;
    file_.tools.emplace_back(layer_, tool);
  }

  void move(const std::map<char, double>& values, bool is_travel) {
    GcodeMove move{at_,       at_,    0.0,       tool_,
                   material_, layer_, is_travel, is_travel ? travel_acceleration_ : track_acceleration_};
    const auto set = [&](char axis, int index) {
      if (values.contains(axis)) move.to[index] = values.at(axis);
    };
    set('X', 0);
    set('Y', 1);
    set('Z', 2);
    if (values.contains('E')) {
      move.filament = is_relative_ ? values.at('E') : values.at('E') - filament_;
      filament_ += move.filament;
    }
    at_ = move.to;
    file_.moves.push_back(move);
  }

  GcodeFile file_;
  Vec3 at_ = Vec3::Zero();
  double filament_ = 0.0;
  double track_acceleration_ = 0.0;
  double travel_acceleration_ = 0.0;
  bool is_relative_ = false;
  int tool_ = -1;
  int layer_ = -1;
  std::string material_;
};

}  // namespace lamella::test
