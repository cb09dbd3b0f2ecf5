// Follows a ray from voxel to voxel to the first that is shown. Lengths are in voxels.

export const vertexShader = `
out vec3 place;
uniform vec3 size;
void main() {
  place = (position + 0.5) * size;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const fragmentShader = `
precision highp float;
precision highp sampler3D;
in vec3 place;
out vec4 color;
uniform sampler3D voxels;
uniform sampler3D blocks;
uniform sampler2D shown;
uniform vec3 size;
uniform vec3 unit;       // mm a voxel
uniform vec3 eye;        // in voxels
uniform vec4 plane;      // n, d: what has dot(n, p) <= d is kept; p in voxels
uniform vec3 planeNormal; // in mm space
uniform vec3 light;
uniform mat4 toClip;     // from voxels

bool isShown(vec4 voxel) {
  return voxel.a > 0.0 && texelFetch(shown, ivec2(int(voxel.a * 255.0 + 0.5), 0), 0).r > 0.5;
}

bool isFull(ivec3 cell) {
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(size)))) return false;
  if (dot(plane.xyz, vec3(cell) + 0.5) > plane.w) return false;
  return isShown(texelFetch(voxels, cell, 0));
}

// Out of the full neighbours: against where they lie.
vec3 normalAt(ivec3 cell, vec3 fallback) {
  vec3 sum = vec3(0.0);
  for (int z = -2; z <= 2; ++z)
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        vec3 way = vec3(x, y, z);
        float far = dot(way, way);
        if (far > 0.0 && far <= 5.0 && isFull(cell + ivec3(x, y, z))) sum -= way / far;
      }
  sum /= unit;
  return dot(sum, sum) > 0.01 ? normalize(sum) : fallback;
}

void main() {
  vec3 way = normalize(place - eye);
  vec3 inverse = 1.0 / (way + vec3(equal(way, vec3(0.0))) * 1e-9);
  vec3 a = -eye * inverse;
  vec3 b = (size - eye) * inverse;
  vec3 near = min(a, b);
  float t = max(max(near.x, near.y), max(near.z, 0.0));
  vec3 far = max(a, b);
  float last = min(far.x, min(far.y, far.z));
  vec3 normal = -sign(way) * vec3(equal(vec3(t), near));
  bool isCut = false;
  float lean = dot(plane.xyz, way);
  float rest = plane.w - dot(plane.xyz, eye);
  if (lean > 0.0) last = min(last, rest / lean);
  else if (lean < 0.0) { if (rest / lean > t) { t = rest / lean; isCut = true; normal = planeNormal; } }
  else if (rest < 0.0) discard;
  vec3 ahead = step(0.0, way);
  bool isFirst = true;
  for (int n = 0; n < 2048; ++n) {
    if (t >= last) break;
    vec3 p = eye + way * (t + 2e-4);
    ivec3 cell = clamp(ivec3(floor(p)), ivec3(0), ivec3(size) - 1);
    bool isEmpty = texelFetch(blocks, cell >> 3, 0).r == 0.0;
    if (!isEmpty) {
      vec4 voxel = texelFetch(voxels, cell, 0);
      if (isShown(voxel)) {
        vec3 hit = eye + way * t;
        bool isFlat = isCut && isFirst;
        vec3 n = isFlat ? planeNormal : normalAt(cell, normal);
        float lit = isFlat ? 1.0 : 0.5 + 0.5 * max(0.0, dot(n, light)) + 0.08 * n.z;
        color = vec4(voxel.rgb * lit, 1.0);
        vec4 clip = toClip * vec4(hit, 1.0);
        gl_FragDepth = clamp(0.5 + 0.5 * clip.z / clip.w, 0.0, 1.0);
        return;
      }
    }
    vec3 low = vec3(isEmpty ? (cell >> 3) << 3 : cell);
    vec3 exits = (low + ahead * (isEmpty ? 8.0 : 1.0) - eye) * inverse;
    float next = min(exits.x, min(exits.y, exits.z));
    normal = -sign(way) * vec3(equal(vec3(next), exits));
    t = max(next, t + 1e-4);
    isFirst = false;
  }
  discard;
}`;
