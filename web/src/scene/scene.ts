// SPDX-License-Identifier: BSD-3-Clause
// The 3-D view of one flight: vehicle, paths, waypoints, wind, estimate with its uncertainty. It draws only when something
// changed, so a page at rest costs nothing.
import {AmbientLight, ArrowHelper, Box3, CircleGeometry, Color, DirectionalLight, Fog, Group, HemisphereLight, Mesh, MeshBasicMaterial,
  type Object3D, PerspectiveCamera, Scene, SphereGeometry, type SpriteMaterial, Vector3, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import type {Triple} from '../data/attitude.ts';
import {path} from '../data/curves.ts';
import {ESTIMATE, type Flight, type PoseTopic} from '../data/flight.ts';
import {deflections, surfacesOf, type Surface} from '../data/surfaces.ts';
import {lastAtOrBefore} from '../data/table.ts';
import {pictureIsMade} from '../pictures.ts';
import {attitudeFromNed, fromNed} from './frames.ts';
import {ground, marker} from './ground.ts';
import {palette, type Palette} from './palette.ts';
import {Trail} from './trail.ts';
import {vehicleModel, type VehicleModel} from './vehicle_model.ts';
import {rotorAngles} from './rotor_angles.ts';

export type View = 'follow' | 'free' | 'above' | 'south' | 'east';

const SIGMAS = 3;
const MAX_POINTS = 6000;
/** A real rotor blurs; at this share of its speed one sees which is faster. */
const ROTOR_SHARE = 0.05;
const WIND_M_PER_M_S = 0.4;

export class FlightScene {
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(45, 1, 0.05, 20000);
  private readonly controls: OrbitControls;
  private scene = new Scene();
  private model: VehicleModel | undefined;
  private vehicle = new Group();
  private cloud: Mesh | undefined;
  private wind: ArrowHelper | undefined;
  /** On the ground below the vehicle. */
  private shadow: Mesh | undefined;
  private trails: {trail: Trail; times: number[]}[] = [];
  private angles: Float64Array[] = [];
  private surfaces: Surface[] = [];
  private flight: Flight | undefined;
  private box = new Box3();
  private view: View = 'follow';
  private time = 0;
  private floor = 0;
  private asked = false;
  private colours: Palette = palette();

  /** @throws Error  the browser has no WebGL. */
  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({canvas, antialias: !navigator.webdriver, preserveDrawingBuffer: navigator.webdriver});
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02; // not from below the ground
    this.controls.addEventListener('change', () => this.ask());
    this.controls.listenToKeyEvents(canvas);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  /** Draws this flight from now on. */
  show(flight: Flight) {
    this.flight = flight;
    this.colours = palette();
    this.build(flight);
    this.setView('follow');
    this.setTime(this.time);
  }

  /** Colours changed, or the flight has grown: all is made again, the camera stays. */
  refresh() {
    if (!this.flight) return;
    this.colours = palette();
    this.build(this.flight);
    this.setTime(this.time);
  }

  setTime(t: number) {
    this.time = t;
    const {flight} = this;
    if (!flight) return;
    const pose = flight.poseAt(t);
    this.vehicle.visible = pose !== undefined;
    if (pose) {
      const before = this.vehicle.position.clone();
      this.vehicle.position.copy(fromNed(pose.p));
      this.vehicle.quaternion.copy(attitudeFromNed(pose.q));
      if (this.view === 'follow') {
        this.camera.position.add(this.vehicle.position.clone().sub(before));
        this.controls.target.copy(this.vehicle.position);
        this.controls.update();
      }
    }
    this.shadow!.visible = this.vehicle.visible;
    this.shadow!.position.set(this.vehicle.position.x, this.floor + 0.01, this.vehicle.position.z);
    this.turnRotors(flight, t);
    for (const [part, angle] of deflections(flight, this.surfaces, t)) this.model?.hinges.get(part)?.rotation.set(angle, 0, 0);
    this.placeCloud(flight, t);
    this.placeWind(flight, t);
    for (const {trail, times} of this.trails) trail.setEnd(lastAtOrBefore(times, times.length, t));
    // The frame of the browser that sets the time draws it too, not the next.
    if (pictureIsMade()) this.draw();
    else this.ask();
  }

  setView(view: View) {
    this.view = view;
    const centre = this.box.getCenter(new Vector3());
    const size = Math.max(this.box.getSize(new Vector3()).length(), 4);
    const far = 0.62 * size / Math.tan(this.camera.fov * Math.PI / 360);
    const away: Record<View, Vector3> = {
      follow: new Vector3(-0.45, 0.5, 1), free: new Vector3(-0.5, 0.55, 1), above: new Vector3(0, 1, 1e-3),
      south: new Vector3(0, 0.02, 1), east: new Vector3(1, 0.02, 0),
    };
    const target = view === 'follow' ? this.vehicle.position.clone() : centre;
    const distance = view === 'follow' ? Math.max(5 * (this.model?.radius ?? 0.5), 2.5) : far;
    this.controls.target.copy(target);
    this.camera.position.copy(away[view].normalize().multiplyScalar(distance).add(target));
    this.camera.far = 40 * size + 1000;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.ask();
  }

  /** Where a point is in the picture: from its left and from its top, as shares of it; undefined when it is not in it. */
  inPicture(point: Vector3): {x: number; y: number} | undefined {
    const at = point.clone().project(this.camera);
    return Math.abs(at.x) > 1 || Math.abs(at.y) > 1 || at.z > 1 ? undefined : {x: (at.x + 1) / 2, y: (1 - at.y) / 2};
  }

  vehicleInPicture() { return this.vehicle.visible ? this.inPicture(this.vehicle.position) : undefined; }

  /** What the picture holds under this name, for tests: a control surface, for example. */
  object(name: string): Object3D | undefined { return this.scene.getObjectByName(name); }

  private build(flight: Flight) {
    const {colours} = this;
    release(this.scene);
    this.scene = new Scene();
    this.scene.background = new Color(colours.sky);
    this.scene.add(new AmbientLight(0xffffff, 0.9), new HemisphereLight(0xffffff, 0x8a8f80, 1.4));
    const sun = new DirectionalLight(0xffffff, 1.8);
    sun.position.set(-3, 8, 4);
    this.scene.add(sun);
    this.trails = [];
    this.box.makeEmpty();
    const truth = flight.poseTopic;
    if (truth?.position.length) this.addTrail('flown', flight, truth, colours.actual, 3.5, true);
    if (truth && truth !== ESTIMATE) this.addTrail('estimate', flight, ESTIMATE, colours.estimate, 1.5, true);
    this.addTrail('setpoint', flight, {topic: '/trajectory_command', position: ESTIMATE.position, attitude: []}, colours.command, 5, false);
    if (this.box.isEmpty()) this.box.expandByPoint(new Vector3());
    this.addPlans(flight);
    this.surfaces = surfacesOf(flight);
    const invertedV = this.surfaces.some(({parts}) => parts.some(([part]) => part.endsWith('tail')));
    this.model = vehicleModel(flight.urdf, {fixedWing: flight.fixedWing, invertedV}, colours);
    const {position} = this.vehicle;
    this.vehicle = new Group().add(this.model.group);
    this.vehicle.name = 'vehicle';
    this.vehicle.position.copy(position);
    this.scene.add(this.vehicle);
    this.angles = rotorAngles(flight, this.model.rotors.length);
    this.addCloud();
    this.floor = Math.min(this.box.min.y - (truth ? 0.15 : 0), 0);
    this.shadow = new Mesh(new CircleGeometry(this.model.radius, 32).rotateX(-Math.PI / 2),
      new MeshBasicMaterial({color: 0x000000, transparent: true, opacity: 0.25, depthWrite: false}));
    this.scene.add(ground(this.box, this.floor, colours).group, this.shadow);
    const size = this.box.getSize(new Vector3()).length();
    this.scene.fog = new Fog(colours.sky, 3 * size + 60, 14 * size + 400);
  }

  private addTrail(name: string, flight: Flight, pose: PoseTopic, colour: string, width: number, ends: boolean) {
    const table = flight.tables.get(pose.topic);
    if (!table) return;
    const {points, rows} = path(table, pose.position, MAX_POINTS);
    if (points.length < 2) return;
    const there = points.map(fromNed);
    for (const point of there) this.box.expandByPoint(point);
    const trail = new Trail(there, colour, width);
    trail.line.name = name;
    this.scene.add(trail.line);
    if (ends) this.trails.push({trail, times: rows.map((row) => table.times[row]!)});
  }

  /** The paths as they were planned, and their corners as waypoints where they are few. */
  private addPlans(flight: Flight) {
    for (const {points} of flight.plans) {
      const there = points.map(fromNed);
      for (const point of there) this.box.expandByPoint(point);
      if (there.length < 2) continue;
      const {line} = new Trail(there, this.colours.route, 1.5);
      line.name = 'plan';
      this.scene.add(line);
    }
    for (const [k, point] of waypoints(flight).entries()) {
      const at = fromNed(point);
      const disc = marker(String(k + 1), this.colours);
      disc.position.copy(at);
      disc.name = `waypoint ${k + 1}`;
      this.scene.add(disc, new Trail([at, new Vector3(at.x, 0, at.z)], this.colours.route, 1).line);
    }
  }

  private addCloud() {
    this.cloud = new Mesh(new SphereGeometry(1, 24, 16),
      new MeshBasicMaterial({color: this.colours.estimate, transparent: true, opacity: 0.2, depthWrite: false}));
    this.wind = new ArrowHelper(new Vector3(1, 0, 0), new Vector3(), 1, this.colours.faint);
    this.cloud.name = 'uncertainty';
    this.wind.name = 'wind';
    this.cloud.visible = this.wind.visible = false;
    this.scene.add(this.cloud, this.wind);
  }

  private turnRotors(flight: Flight, t: number) {
    const table = flight.tables.get('/sim/truth_vehicle');
    const row = Math.max(table?.rowAt(t) ?? 0, 0);
    this.model?.rotors.forEach((rotor, k) => {
      rotor.rotation.y = (k % 2 === 0 ? 1 : -1) * ROTOR_SHARE * (this.angles[k]?.[row] ?? 0);
    });
  }

  /** The estimated position and what the filter says of its error: three standard deviations along each axis. */
  private placeCloud(flight: Flight, t: number) {
    const pose = flight.poseTopic === ESTIMATE ? undefined : flight.poseAt(t, ESTIMATE);
    const sigma = [0, 1, 2].map((k) => flight.valueAt(ESTIMATE.topic, `position_sigma[${k}]`, t));
    this.cloud!.visible = pose !== undefined && sigma.every((value) => value > 0);
    if (!pose || !this.cloud!.visible) return;
    this.cloud!.position.copy(fromNed(pose.p));
    this.cloud!.scale.set(SIGMAS * sigma[1]!, SIGMAS * sigma[2]!, SIGMAS * sigma[0]!);
  }

  private placeWind(flight: Flight, t: number) {
    const [n, e, d] = ['x', 'y', 'z'].map((axis) => flight.valueAt('/sim/truth_vehicle', `wind.${axis}`, t));
    const along = fromNed([n!, e!, d!]);
    const speed = along.length();
    this.wind!.visible = this.vehicle.visible && speed > 0.1;
    if (!this.wind!.visible) return;
    const reach = 2 * (this.model?.radius ?? 0.5);
    this.wind!.position.copy(this.vehicle.position).add(new Vector3(0, reach, 0));
    this.wind!.setDirection(along.normalize());
    this.wind!.setLength(WIND_M_PER_M_S * speed * Math.max(reach, 0.5), 0.2 * reach, 0.12 * reach);
  }

  private resize() {
    const canvas = this.renderer.domElement;
    const {clientWidth: width, clientHeight: height} = canvas.parentElement ?? canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { if (this.asked) this.draw(); });
  }

  private draw() {
    this.asked = false;
    this.renderer.render(this.scene, this.camera);
    this.renderer.domElement.dataset['frames'] = String(Number(this.renderer.domElement.dataset['frames'] ?? 0) + 1);
  }
}

/** Gives back what the graphics card holds of a scene. */
function release(scene: Scene) {
  scene.traverse((object) => {
    const {geometry, material} = object as Partial<Mesh>;
    geometry?.dispose();
    for (const one of [material ?? []].flat()) {
      (one as SpriteMaterial).map?.dispose();
      one.dispose();
    }
  });
}

/** Those of the mission where the folder has them, else the corners of a multirotor's plan; that of a fixed wing is a curve around them. */
function waypoints(flight: Flight): readonly Triple[] {
  return flight.analysis?.waypoints.map(({position_m}) => position_m) ?? (flight.fixedWing ? [] : flight.plans[0]?.points ?? []);
}
