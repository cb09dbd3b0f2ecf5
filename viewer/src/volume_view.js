// The 3D picture: the voxels in a box, a plane that cuts them, axes in mm.

import {
  BackSide,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  Data3DTexture,
  DataTexture,
  GLSL3,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  NearestFilter,
  PerspectiveCamera,
  RedFormat,
  RGBAFormat,
  Scene,
  Sprite,
  SRGBColorSpace,
  SpriteMaterial,
  CanvasTexture,
  UnsignedByteType,
  Vector3,
  Vector4,
  WebGLRenderer,
  ShaderMaterial,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { makeVoxels } from './volume_data.js';
import { fragmentShader, vertexShader } from './voxel_shader.js';
import { mm } from './planes.js';

const kFrame = 40; // ms a frame may take while the view moves; above, fewer pixels are drawn

function texture3d(data, size, format) {
  const texture = new Data3DTexture(data, ...size);
  texture.format = format;
  texture.type = UnsignedByteType;
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

export class VolumeView {
  constructor(root, build, palette, events) {
    Object.assign(this, { root, build, palette, events });
    this.clip = { axis: 'y', share: 0.5, flip: false };
    this.marks = [];
    this.frameTimes = [];
    this.ratio = 1;
  }

  /** Makes the voxels and the scene; throws when the browser has no WebGL 2. */
  async open(report) {
    if (this.renderer) return;
    const data = await makeVoxels(this.build, this.palette, report);
    this.data = data;
    this.renderer = new WebGLRenderer({ antialias: false, alpha: true, preserveDrawingBuffer: true });
    this.root.append(this.renderer.domElement);
    const { origin, pitch } = this.build.grid;
    const height = this.build.zHigh - this.build.zLow;
    this.unit = [data.step[0] * pitch[0], data.step[1] * pitch[1], height / data.size[2]];
    this.dims = this.unit.map((unit, axis) => unit * data.size[axis]);
    this.low = [origin[0], origin[1], this.build.zLow];
    this.makeScene();
    new ResizeObserver(() => this.resize()).observe(this.root);
    this.resize();
    this.home();
  }

  /** World coordinates are mm from the lower corner of the box. */
  makeScene() {
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => {
      this.moving = true;
    });
    this.controls.addEventListener('end', () => this.settle());
    this.scene.add(this.makeVoxelBox());
    this.refreshTheme();
  }

  /** Lines and labels in the page's colours. */
  refreshTheme() {
    if (!this.scene) return;
    this.scene.remove(...[this.lines, ...(this.labels ?? [])].filter(Boolean));
    const style = getComputedStyle(this.root);
    this.ink = style.getPropertyValue('--ink').trim();
    this.paper = style.getPropertyValue('--stage').trim();
    this.lines = this.makeLines();
    this.labels = this.makeLabels();
    this.scene.add(this.lines, ...this.labels);
    this.draw();
  }

  makeVoxelBox() {
    const { data } = this;
    this.shownTexture = new DataTexture(new Uint8Array(256), 256, 1, RedFormat, UnsignedByteType);
    this.material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      side: BackSide,
      uniforms: {
        voxels: { value: texture3d(new Uint8Array(data.voxels.buffer), data.size, RGBAFormat) },
        blocks: { value: texture3d(data.coarse, data.blocks, RedFormat) },
        shown: { value: this.shownTexture },
        size: { value: new Vector3(...data.size) },
        unit: { value: new Vector3(...this.unit) },
        eye: { value: new Vector3() },
        plane: { value: new Vector4() },
        planeNormal: { value: new Vector3() },
        light: { value: new Vector3() },
        toClip: { value: new Matrix4() },
      },
    });
    const box = new Mesh(new BoxGeometry(1, 1, 1), this.material);
    box.scale.set(...this.dims);
    box.position.set(...this.dims.map((size) => size / 2));
    this.refreshShown();
    return box;
  }

  makeLines() {
    return new LineSegments(
      boxGeometry([0, 0, 0], this.dims),
      new LineBasicMaterial({ color: new Color(this.ink), transparent: true, opacity: 0.55 }),
    );
  }

  /** Beside the edges of the box that are nearest at first. */
  makeLabels() {
    const [x, y, z] = this.dims;
    const text = this.low.map((low, axis) => `${'xyz'[axis]}: ${mm(low)} to ${mm(low + this.dims[axis])} mm`);
    // The point of each label that lies at its place: 0 left and bottom, 1 right and top.
    return [
      [text[0], [0.5, 1.3], x / 2, 0, 0],
      [text[1], [0.35, 1.6], x, y / 2, 0],
      [text[2], [0.5, -0.5], 0, 0, z],
    ].map(([label, anchor, ...at]) => {
      const sprite = makeLabel(label, this.ink, this.paper);
      sprite.center.set(...anchor);
      sprite.position.set(...at);
      return sprite;
    });
  }

  setMarks(marks, inks) {
    for (const line of this.markLines ?? []) this.scene?.remove(line);
    this.markLines = [];
    if (!this.scene) return;
    for (const { box, kind } of marks) {
      if (!box) continue;
      const corner = (value) => value.map((v, axis) => v - this.low[axis]);
      const line = new LineSegments(
        boxGeometry(corner(box.low), corner(box.high)),
        new LineBasicMaterial({ color: new Color(inks[kind]) }),
      );
      this.markLines.push(line);
      this.scene.add(line);
    }
    this.draw();
  }

  refreshShown() {
    if (!this.shownTexture) return;
    const { data } = this.shownTexture.image;
    this.palette.shown.forEach((shown, m) => {
      data[Math.min(m + 1, 255)] = shown ? 255 : 0;
    });
    this.shownTexture.needsUpdate = true;
    this.draw();
  }

  home() {
    const centre = new Vector3(...this.dims).multiplyScalar(0.5);
    const way = new Vector3(0.42, -0.9, 0.62).normalize();
    const distance = this.fittingDistance(centre, way);
    const reach = centre.length();
    this.camera.near = Math.max(distance - 2 * reach, reach / 100) / 10;
    this.camera.far = (distance + reach) * 20;
    this.camera.position.copy(centre).addScaledVector(way, distance);
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(centre);
    this.controls.update();
    this.draw();
  }

  /** How far off, along `way` from the centre, the camera sees all corners of the box and room for its labels. */
  fittingDistance(centre, way) {
    const right = new Vector3().crossVectors(this.camera.up, way).normalize();
    const over = new Vector3().crossVectors(way, right);
    const slope = Math.tan(((this.camera.fov / 2) * Math.PI) / 180) / 1.18;
    let distance = 0;
    for (let n = 0; n < 8; ++n) {
      const corner = new Vector3(...this.dims.map((size, axis) => ((n >> axis) & 1 ? size : 0))).sub(centre);
      const least = Math.max(
        Math.abs(corner.dot(right)) / (slope * this.camera.aspect),
        Math.abs(corner.dot(over)) / slope,
      );
      distance = Math.max(distance, corner.dot(way) + least);
    }
    return distance;
  }

  /** By degrees about the upright axis and towards it; by a factor nearer. */
  turn(around, over, nearer = 1) {
    const { camera, controls } = this;
    const offset = camera.position.clone().sub(controls.target);
    offset.applyAxisAngle(camera.up, (around * Math.PI) / 180);
    const side = new Vector3().crossVectors(camera.up, offset).normalize();
    const turned = offset.clone().applyAxisAngle(side, (over * Math.PI) / 180);
    const lean = turned.angleTo(camera.up);
    camera.position
      .copy(controls.target)
      .add((lean > 0.05 && lean < Math.PI - 0.05 ? turned : offset).multiplyScalar(nearer));
    controls.update();
    this.draw();
  }

  setClip(clip) {
    if (clip.axis === 'view' && (this.clip.axis !== 'view' || !this.viewNormal) && this.camera) {
      this.viewNormal = this.camera.position.clone().sub(this.controls.target).normalize();
    }
    Object.assign(this.clip, clip);
    this.draw();
  }

  /** Unit normal in mm and the distance at which the plane lies; what is behind it is kept. */
  clipPlane() {
    const { axis, share, flip } = this.clip;
    const normal =
      axis === 'view'
        ? (this.viewNormal ?? new Vector3(0, -1, 0)).clone()
        : new Vector3(...['x', 'y', 'z'].map((name) => (name === axis ? 1 : 0)));
    const reaches = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
      normal.dot(new Vector3(...this.dims.map((size, n) => ((corner >> n) & 1) * size))),
    );
    const [low, high] = [Math.min(...reaches), Math.max(...reaches)];
    const distance = low + share * (high - low);
    // Cuts across y show themselves from the front, where the camera starts: what is further back is kept.
    const isTurned = flip !== (axis === 'y');
    return { normal: normal.multiplyScalar(isTurned ? -1 : 1), distance: isTurned ? -distance : distance, low, high };
  }

  /** "y = 3.2 mm", or how far the plane lies along its normal. */
  clipLabel() {
    const { axis, share } = this.clip;
    if (axis === 'none' || !this.dims) return '';
    if (axis === 'view') return `${Math.round(share * 100)} % of the way`;
    const n = 'xyz'.indexOf(axis);
    return `${axis} = ${mm(this.low[n] + share * this.dims[n])} mm`;
  }

  resize() {
    const { width, height } = this.root.getBoundingClientRect();
    if (!this.renderer || !width || !height) return;
    this.renderer.setPixelRatio((window.devicePixelRatio || 1) * this.ratio);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (!this.renderer || this.root.hidden) return;
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      this.render();
    });
  }

  render() {
    const start = performance.now();
    const { uniforms } = this.material;
    const toVoxels = (v) => new Vector3(...v.toArray().map((value, axis) => value / this.unit[axis]));
    uniforms.eye.value.copy(toVoxels(this.camera.position));
    const { normal, distance } = this.clipPlane();
    uniforms.plane.value.set(
      ...(this.clip.axis === 'none'
        ? [0, 0, 0, 1]
        : [...normal.toArray().map((n, axis) => n * this.unit[axis]), distance]),
    );
    uniforms.planeNormal.value.copy(normal);
    const back = this.camera.position.clone().sub(this.controls.target).normalize();
    uniforms.light.value.copy(
      back
        .addScaledVector(this.camera.up, 0.55)
        .add(new Vector3(-0.25, 0, 0))
        .normalize(),
    );
    this.camera.updateMatrixWorld();
    uniforms.toClip.value
      .multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse)
      .multiply(new Matrix4().makeScale(...this.unit));
    this.renderer.render(this.scene, this.camera);
    // Reading a pixel waits until the frame is there, so that its time is known.
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    this.adapt(performance.now() - start);
  }

  /** Fewer pixels while it moves too slowly. */
  adapt(time) {
    this.frameTimes.push(time);
    if (this.moving && time > kFrame && this.ratio > 0.3) {
      this.ratio = Math.max(0.3, this.ratio * 0.75);
      this.resize();
    }
    this.events.drawn?.();
  }

  settle() {
    this.moving = false;
    if (this.ratio === 1) return;
    this.ratio = 1;
    this.resize();
  }
}

function boxGeometry(low, high) {
  const corner = (n) => [0, 1, 2].map((axis) => ((n >> axis) & 1 ? high[axis] : low[axis]));
  const edges = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
  ];
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(edges.flat().flatMap(corner)), 3));
  return geometry;
}

/** As large on the screen from everywhere. */
function makeLabel(text, ink, paper) {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d');
  const font = '32px system-ui, sans-serif';
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 16;
  canvas.height = 48;
  context.font = font;
  // A halo in the colour behind, so that lines of the box don't strike it through.
  context.strokeStyle = paper;
  context.lineWidth = 12;
  context.lineJoin = 'round';
  context.strokeText(text, 8, 34);
  context.fillStyle = ink;
  context.fillText(text, 8, 34);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, transparent: true, sizeAttenuation: false, depthTest: false }));
  sprite.renderOrder = 1; // over the lines
  const height = 0.019;
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  return sprite;
}
