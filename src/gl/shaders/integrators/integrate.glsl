// What every integrator comes to. A source may take segments piece by piece instead, so that rays side by side do not
// wait for each other: begin(segment, front), then advance(front, sum) while is_pending(front).

void integrate(Segment segment, inout Front front, inout vec4 sum) {
  begin(segment, front);
  while (is_pending(front)) advance(front, sum);
}
