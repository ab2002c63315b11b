#include "src/gl/all_programs.h"

#include "src/gl/slice_programs.h"
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

void add_slices(std::vector<ProgramRecipe>& programs) {
  programs.push_back({"slices, box", recipe_of_box()});
  programs.push_back({"slices, filter", recipe_of_filter()});
  programs.push_back({"slices, stack", {recipe_of_stack()}});
  programs.push_back({"slices, gradients", {recipe_of_gradients()}});
  for (const SliceVariant& variant : slice_variants())
    for (const IntegratorShader& integrator : all_integrator_shaders()) {
      const bool is_segment = variant.classification == SliceClassification::kSegment;
      if (is_segment && (integrator.name == "cell data" || integrator.name == "post")) continue;
      if (!is_segment && integrator.name != "post") continue;  // looks nothing up
      const std::string key = key_of(integrator, variant);
      programs.push_back({"slab " + key, recipe_of_slab(integrator, variant)});
      if (variant.is_half_angle) programs.push_back({"light " + key, recipe_of_light(integrator, variant)});
    }
}

}  // namespace

std::vector<ProgramRecipe> all_programs() {
  std::vector<ProgramRecipe> programs;
  add_walk(programs);
  add_slices(programs);
  return programs;
}

}  // namespace tetravox::gl
