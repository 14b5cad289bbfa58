// SPDX-License-Identifier: BSD-3-Clause
// Types of dynpoint. What a field means, its unit and its range stand in the header that is named beside its struct.

export type Vector = [number, number, number];
/** Position, m, and a unit quaternion: x, y, z, qw, qx, qy, qz. */
export type Pose = [number, number, number, number, number, number, number];
/** Two ends and a radius, m. */
export type Segment = [number, number, number, number, number, number, number];
/** Numbers that go in: a list, or a typed array of that length. */
export type Numbers<List extends readonly number[]> = Readonly<List> | Float64Array;
/** The fields that differ from the defaults, or that are to change. */
export type Settings<Struct> = {
  readonly [Key in keyof Struct]?: Struct[Key] extends readonly number[] ? Numbers<Struct[Key]> : Struct[Key];
};
/** Bytes that go in. */
export type Bytes = ArrayBuffer | ArrayBufferView;

/** The number of a body or a tool in its world; 0 is none. */
export type Body = number;
export type Tool = number;

/** What a call of the library refuses. A call that throws has changed nothing. */
export declare class DynpointError extends Error {
  constructor(code: Result, message: string, place?: { line?: number; byte?: number });
  /** As "DPT_E_HANDLE". */
  readonly code: Result;
  /** Of a source that does not compile, where it is known. */
  readonly line?: number;
  readonly byte?: number;
}

export interface Wrench {
  /** N */
  force: Vector;
  /** N m */
  torque: Vector;
}

export interface Energy {
  /** J */
  elastic: number;
  kinetic: number;
}

export interface Triangles {
  /** Three vertices each. */
  corners: Uint32Array;
  /** Of the source. */
  numbers: Uint32Array;
}

export interface CompileOptions {
  /** What the coordinates are multiplied by: 0.001 for mm. */
  scale?: number;
  /** Radians; above it an edge is a crease. */
  crease?: number;
  recentre?: number;
  threads?: number;
  /** Where the content does not tell it. */
  format?: "auto" | "obj" | "stl" | "ply" | "off";
  springs?: Settings<Omit<SpringNetDef, "kind">> & {
    readonly kind: "sheet" | "volume";
    /** Vertices that do not move. */
    readonly fixed?: Iterable<number>;
    readonly regions?: readonly Settings<SpringRegion>[];
  };
}

/** The compiler of meshes. */
export interface Compiler {
  readonly version: string;
  /** The bytes of an OBJ, STL, PLY or OFF, to those of a .dpa. */
  compile(source: Bytes, options?: CompileOptions): Uint8Array;
  /** Three numbers a vertex, three vertices a triangle. */
  compileArrays(vertices: Float64Array, corners: Uint32Array, options?: CompileOptions): Uint8Array;
}

/** A compiled mesh in the memory of a core. */
export interface Mesh {
  readonly info: MeshInfo;
  /** Three numbers each, m. */
  getVertices(): Float32Array;
  getTriangles(): Triangles;
  /** Gives its memory back. Refused while a world uses it. */
  close(): void;
}

/** Bodies and tools, and the step. */
export interface World {
  /** The kernel in use, as "wasm128". */
  readonly kernel: string;
  addBody(mesh: Mesh, pose?: Numbers<Pose>): Body;
  addDeform(mesh: Mesh, def?: Settings<DeformableDef>, pose?: Numbers<Pose>): Body;
  removeBody(body: Body): void;
  setBodyPose(body: Body, pose: Numbers<Pose>): void;
  teleportBody(body: Body, pose: Numbers<Pose>): void;
  getBodyPose(body: Body): Pose;
  getBodySettings(body: Body): BodySettings;
  setBodySettings(body: Body, settings: Settings<BodySettings>): void;
  getBodyWrench(body: Body): Wrench;
  /** Springs of a mesh that was compiled with them. */
  addSprings(body: Body, def?: Settings<SpringsDef>): void;
  /** After a step of the world; dt in s. */
  stepSprings(body: Body, dt: number): SpringsInfo;
  getSpringsEnergy(body: Body): Energy;
  /** Three numbers each, m, in the body's frame, from vertex `first` on. */
  setVertices(body: Body, positions: Float32Array, first?: number): void;
  getVertices(body: Body): Float32Array;
  addTool(segments: readonly Numbers<Segment>[]): Tool;
  removeTool(tool: Tool): void;
  setToolSegments(tool: Tool, segments: readonly Numbers<Segment>[]): void;
  setToolPose(tool: Tool, pose: Numbers<Pose>): void;
  teleportTool(tool: Tool, pose: Numbers<Pose>): void;
  getToolPose(tool: Tool): Pose;
  getToolProxy(tool: Tool): Pose;
  /** Where a tool that is too fast for one tick has got to. */
  getToolEnd(tool: Tool): Pose;
  getToolSettings(tool: Tool): ToolSettings;
  setToolSettings(tool: Tool, settings: Settings<ToolSettings>): void;
  /** One tick; dt in s. With `false` it tells nothing, and hits are found when they are read. */
  step(dt: number, isTold?: true): Step;
  step(dt: number, isTold: false): void;
  reset(): void;
  getInfo(): WorldInfo;
  getHit(tool: Tool): Hit;
  getSegmentHit(tool: Tool, segment: number): Hit;
  getWrench(tool: Tool): Wrench;
  getForceInfo(tool: Tool): ForceInfo;
  getContacts(tool: Tool): Contact[];
  getLoads(tool: Tool): ToolLoad[];
  /** A view into the core's memory, good until the next call: the block of snapshot.h. */
  getSnapshot(def?: Settings<SnapshotDef>): Uint8Array;
  close(): void;
}

/** A core, with a memory of its own, for one thread. */
export interface Core {
  readonly version: string;
  readonly kernels: string[];
  /** All C functions: an address is a number, and what has 64 bits a BigInt. */
  readonly exports: CoreExports;
  /** The bytes of a .dpa. They are copied. */
  openMesh(file: Bytes): Mesh;
  createWorld(def?: Settings<WorldDef>): World;
  /** The stiffest coupling that a device holds. */
  couplingForDevice(def: Settings<CouplingDef>): Coupling;
  stableStiffness(mass: number, damping: number, period: number, delay: number, virtualDamping: number): number;
}

/** Which ticks are due by a clock in ms. */
export declare class Pace {
  /** s */
  constructor(options?: { readonly period?: number; readonly catchUp?: number });
  /** ms */
  readonly period: number;
  readonly catchUp: number;
  /** Ticks that were taken: count them here. */
  done: number;
  begin(now: number): void;
  /** ms by which the next tick is behind its time. */
  late(now: number): number;
  /** Leaves out what is later than catchUp; how many ticks. */
  skip(now: number): number;
  due(now: number): number;
}

/** How a loop waits for the next tick. */
export type Wait = "sleep" | "turn" | "timer";

/** s */
export interface Spread {
  median: number;
  p99: number;
  most: number;
}

export interface LoopInfo {
  ticks: number;
  /** Ticks that were left out. */
  lost: number;
  wait: Wait;
  /** How late the last ticks began. */
  late: Spread;
  /** What they took. */
  took: Spread;
}

/** Calls a function each period. Run it in a worker. */
export declare class Loop {
  constructor(
    tick: (number: number) => void,
    options?: { readonly period?: number; readonly catchUp?: number; readonly wait?: Wait },
  );
  readonly wait: Wait;
  readonly isRunning: boolean;
  readonly ticks: number;
  readonly lost: number;
  /** Until stop(). What a tick throws ends it, and is thrown here. */
  run(): Promise<LoopInfo>;
  stop(): void;
  getInfo(): LoopInfo;
}

/** Without a source: the module that lies in this package. */
export declare function openCore(source?: Bytes | WebAssembly.Module): Promise<Core>;
export declare function openCompiler(source?: Bytes | WebAssembly.Module): Promise<Compiler>;

/** Where the fields of each struct lie, by the name of C; for calls of core.exports. */
export declare const layouts: { readonly [struct: string]: Layout };
export interface Layout {
  readonly bytes: number;
  readonly hasSize: boolean;
  readonly fields: readonly Field[];
  readonly byName: ReadonlyMap<string, Field>;
}
export interface Field {
  readonly name: string;
  readonly type: "u32" | "i32" | "f32" | "u64" | "i64" | "f64" | "bits" | "text" | "p";
  readonly offset: number;
  readonly count: number;
  readonly isOwnSize: boolean;
}

/*@STRUCTS@*/
/*@CONSTANTS@*/
/*@EXPORTS@*/
/*@MODULE@*/
declare const dynpoint: {
  openCore: typeof openCore;
  openCompiler: typeof openCompiler;
  constants: typeof constants;
  layouts: typeof layouts;
  DynpointError: typeof DynpointError;
  Pace: typeof Pace;
  Loop: typeof Loop;
};
export default dynpoint;
