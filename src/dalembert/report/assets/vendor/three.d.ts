// Names of three.js in the scripts of spatial drawings. Its objects are not checked.

declare const THREE: any;
declare namespace THREE {
  type BufferGeometry = any;
  type Camera = any;
  type Group = any;
  type LineSegments2 = any;
  type Material = any;
  type Mesh = any;
  type Object3D = any;
  type Quaternion = any;
  type Scene = any;
  type Vector3 = any;
}
