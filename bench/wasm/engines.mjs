// The engines that race.mjs races. Each gets the poses of all bodies in a Float64Array, seven numbers for
// each body: position, and quaternion w, x, y, z. `move` passes them to the engine by its usual interface,
// `detect` finds all contacts with manifolds. No contact is solved: bodies of the other engines are
// kinematic.
import {readFile} from 'node:fs/promises';
import {WASI} from 'node:wasi';

const SECONDS = 1 / 60;

export async function winnowInWasm(file, count) {
  const wasi = new WASI({version: 'preview1'});
  const module = await WebAssembly.compile(await readFile(file));
  const {exports} = await WebAssembly.instantiate(module, wasi.getImportObject());
  wasi.initialize({exports});
  if (!exports.drift_start(count)) throw new Error('winnow refuses the scene');
  let touching = 0;
  return {
    name: 'winnow',
    advance: () => exports.drift_advance(),
    poses: () => new Float64Array(exports.memory.buffer, exports.drift_poses(), 7 * count),
    move: () => { exports.drift_move(); },
    detect: () => { touching = exports.drift_detect(); },
    touching: () => touching,
  };
}

export async function jolt(init, count) {
  const Jolt = await init();
  const settings = new Jolt.JoltSettings();
  settings.mMaxBodies = count;
  settings.mMaxBodyPairs = 8 * count;
  settings.mMaxContactConstraints = 2 * count;
  const layers = new Jolt.ObjectLayerPairFilterTable(1);
  layers.EnableCollision(0, 0);
  const broadPhase = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  broadPhase.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = layers;
  settings.mBroadPhaseLayerInterface = broadPhase;
  settings.mObjectVsBroadPhaseLayerFilter =
    new Jolt.ObjectVsBroadPhaseLayerFilterTable(broadPhase, 1, layers, 1);
  const engine = new Jolt.JoltInterface(settings);
  const system = engine.GetPhysicsSystem();
  const physics = system.GetPhysicsSettings();
  physics.mSpeculativeContactDistance = 0;
  system.SetPhysicsSettings(physics);
  const bodies = system.GetBodyInterface();
  const position = new Jolt.RVec3(0, 0, 0);
  const rotation = new Jolt.Quat(0, 0, 0, 1);
  const shapes = [new Jolt.SphereShape(0.5), new Jolt.BoxShape(new Jolt.Vec3(0.5, 0.5, 0.5), 0)];
  const ids = [];
  for (let i = 0; i < count; ++i) {
    const made = new Jolt.BodyCreationSettings(shapes[i % 2], position, rotation,
                                               Jolt.EMotionType_Kinematic, 0);
    made.mIsSensor = true;
    made.mCollideKinematicVsNonDynamic = true;
    made.mAllowSleeping = false;
    const body = bodies.CreateBody(made);
    Jolt.destroy(made);
    bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
    ids.push(body.GetID());
  }
  return {
    name: 'Jolt',
    move(poses) {
      for (let i = 0, k = 0; i < count; ++i, k += 7) {
        position.Set(poses[k], poses[k + 1], poses[k + 2]);
        rotation.Set(poses[k + 4], poses[k + 5], poses[k + 6], poses[k + 3]);
        bodies.SetPositionAndRotation(ids[i], position, rotation, Jolt.EActivation_Activate);
      }
    },
    detect: () => engine.Step(SECONDS, 1),
    touching() {
      let found = 0;
      for (let i = 0; i < count; ++i) {
        for (let j = i + 1; j < count; ++j) {
          if (system.WereBodiesInContact(ids[i], ids[j])) ++found;
        }
      }
      return found;
    },
  };
}

export function rapier(rapier3d, count) {
  const world = new rapier3d.World({x: 0, y: 0, z: 0});
  world.timestep = SECONDS;
  const shapes = [() => rapier3d.ColliderDesc.ball(0.5), () => rapier3d.ColliderDesc.cuboid(0.5, 0.5, 0.5)];
  const bodies = [];
  const colliders = [];
  for (let i = 0; i < count; ++i) {
    bodies.push(world.createRigidBody(rapier3d.RigidBodyDesc.kinematicPositionBased()));
    const shape = shapes[i % 2]().setActiveCollisionTypes(rapier3d.ActiveCollisionTypes.ALL);
    colliders.push(world.createCollider(shape, bodies[i]));
  }
  return {
    name: 'Rapier',
    move(poses) {
      for (let i = 0, k = 0; i < count; ++i, k += 7) {
        bodies[i].setTranslation({x: poses[k], y: poses[k + 1], z: poses[k + 2]}, true);
        bodies[i].setRotation(
          {w: poses[k + 3], x: poses[k + 4], y: poses[k + 5], z: poses[k + 6]}, true);
      }
    },
    detect: () => world.step(),
    touching() {
      let found = 0;
      for (const a of colliders) {
        world.contactPairsWith(a, (b) => {
          if (b.handle <= a.handle) return;
          let deepest = Infinity;
          world.contactPair(a, b, (manifold) => {
            for (let k = 0; k < manifold.numContacts(); ++k) {
              deepest = Math.min(deepest, manifold.contactDist(k));
            }
          });
          if (deepest <= 0) ++found;
        });
      }
      return found;
    },
  };
}
