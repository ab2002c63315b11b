// What rays of the source `march` leave behind, pass by pass.

layout(binding = 0, rgba32f) uniform writeonly image2D picture;

layout(std430, binding = 0) buffer Counters {
  uint unfinished_count;  // rays that need another pass
  uint waiting_count;     // rays that have come to a brick whose values are not there yet
  uint met_count;         // rays that met a brick which is seen
  uint segments[64];      // spread, so that they are not fought for
} counters;

struct Pause {  // what a ray needs to go on in another pass
  vec4 sum;
  float z;      // kNever: it has arrived
  uint has_met;
  float sample_depth, sample_number;  // see `Carried`; of runs, the number of the step taken last
  vec4 sample_value;
};
layout(std430, binding = 1) buffer Pauses { Pause pauses[]; };  // [rows][width]

bool is_over(vec4 sum) {
  return frame.use_early_ray_termination != 0 && (sum.a < march.negligible || is_settled(sum));
}

void arrive(ivec2 pixel, uint place, bool has_met, vec4 sum) {
  pauses[place].z = kNever;
  if (has_met) atomicAdd(counters.met_count, 1u);
  imageStore(picture, pixel, min(vec4(sum.rgb, 1.0 - sum.a), 1.0));
}

void count_segments(uint place) {
  if (segment_count > 0u) atomicAdd(counters.segments[place % 64u], segment_count);
}
