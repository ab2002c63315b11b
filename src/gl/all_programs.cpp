#include "src/gl/all_programs.h"

#include "src/gl/table_maker.h"
#include "src/gl/walk_passes.h"

namespace tetravox::gl {
namespace {

void add_walk(std::vector<ProgramRecipe>& programs) {
  programs.push_back({"lists", recipe_of_lists()});
  programs.push_back({"peeling", recipe_of_peeling()});
  programs.push_back({"sorting", {recipe_of_sorting()}});
  for (const EntryOrder order : {EntryOrder::kLists, EntryOrder::kPeeling})
    for (const bool is_behind_eye : {false, true})
      for (const IntegratorShader& integrator : all_integrator_shaders()) {
        const WalkVariant variant{integrator.name == "cell data", is_behind_eye, order};
        programs.push_back({"walk by " + name_of(order) + ", " + integrator.name + (is_behind_eye ? ", behind" : ""),
                            {recipe_of_walk(integrator, variant)}});
      }
}

}  // namespace

std::vector<ProgramRecipe> all_programs() {
  std::vector<ProgramRecipe> programs;
  add_walk(programs);
  for (const auto& [name, stages] : recipes_of_tables()) programs.push_back({"tables, " + name, stages});
  return programs;
}

}  // namespace tetravox::gl
