#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "model/step/part21.h"

/// Private to model/step: solids, shells and faces as the file states them, before the import heals anything.
namespace lamella::step {

/// A fault of one solid that is visible in the file itself.
struct RawFault {
  int solid = 0;        ///< entity of the solid, of the shell when it has none
  int face = 0;         ///< 0 when it concerns a shell
  int entity = 0;       ///< the entity at fault
  bool breaks = false;  ///< the boundary isn't closed or contradicts itself, rather than being misnamed
  std::string what;
};

struct RawShell {
  int number = 0;
  bool declared_open = false;
  std::vector<int> faces;
};

struct RawSolid {
  int number = 0;  ///< of the solid, of the shell when the shell stands alone
  bool alone = false;
  std::vector<RawShell> shells;
};

class RawTopology {
 public:
  explicit RawTopology(const Part21& file, const Progress& progress = {});

  [[nodiscard]] const std::vector<RawSolid>& solids() const { return solids_; }
  /// The face that an entity of its boundary or surface belongs to, the face's own number for itself, else 0. Of
  /// entities that several faces share the first.
  [[nodiscard]] int face_of(int entity) const { return look_up(face_of_, entity); }
  /// The solid that a face or shell belongs to (the shell if it stands alone), else 0.
  [[nodiscard]] int solid_of(int face_or_shell) const { return look_up(solid_of_, face_or_shell); }
  [[nodiscard]] const std::vector<RawFault>& faults() const { return faults_; }

 private:
  struct EdgeUse {
    int edge = 0;
    bool forward = true;
    int face = 0;
  };
  using Uses = std::vector<EdgeUse>;

  [[nodiscard]] static int look_up(const std::unordered_map<int, int>& map, int key);
  void read_solid(int number);
  void read_shell(RawSolid& solid, int number, int depth = 0);
  void read_face(int solid, int number, bool turned, Uses& uses, int depth = 0);
  void read_loop(int loop, int face, bool turned, Uses& uses);
  void check_uses(int solid, const RawShell& shell, const Uses& uses);
  void add_fault(int solid, int face, int entity, bool breaks, std::string what);
  void claim(int entity, int face);

  const Part21& file_;
  std::vector<RawSolid> solids_;
  std::unordered_map<int, int> face_of_;
  std::unordered_map<int, int> solid_of_;
  std::vector<RawFault> faults_;
};

}  // namespace lamella::step
