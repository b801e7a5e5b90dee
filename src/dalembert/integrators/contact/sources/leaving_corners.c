/* Corners that leave the faces of hulls before they would touch them */
/* distance by which a place is beyond side j of a face with a normal, or of two ends of a planar side */
static casadi_real casadi_beyond(const int* form, const casadi_real* corners,
    const casadi_real* normal, casadi_int face, casadi_int j, casadi_int dimension,
    const casadi_real* place) {
  const int* loop = form;
  casadi_int p, q, count;
  casadi_real side[3], outward[3], relative[3];
  if (dimension==2) {
    p = face+1<form[CORNERS] ? face + 1 : 0;
    q = j ? face : p;
    p = j ? p : face;
    casadi_between(corners + 3*q, corners + 3*p, outward);
  } else {
    loop = form + form[LOOP_CORNERS] + form[form[LOOP_STARTS]+face];
    count = form[form[LOOP_STARTS]+face+1] - form[form[LOOP_STARTS]+face];
    p = loop[j];
    q = loop[j+1<count ? j + 1 : 0];
    casadi_between(corners + 3*p, corners + 3*q, side);
    casadi_cross(side, normal, outward);
  }
  casadi_unit(outward);
  casadi_between(corners + 3*p, place, relative);
  return casadi_dot(outward, relative);
}
/* whether a sharp corner over a face is past the end of the face when the gap closes, if the bodies move
   on as to the middle of the step, but for a share of a step; gaps that would close later than within
   some steps or are at rest remain */
static int casadi_leaves(const casadi_real** arg, const casadi_real** ahead, const int* contact,
    casadi_int dimension) {
  const int* place = (const int*) arg[PLACES];
  const int* form = (const int*) arg[FORMS] + place[5*contact[SHAPE]];
  const casadi_real* normal = arg[AXES] + 3*(place[5*contact[SHAPE]+AXES] + contact[FEATURE]);
  const casadi_real* turned = ahead[AXES] + 3*(place[5*contact[SHAPE]+AXES] + contact[FEATURE]);
  const casadi_real* from = arg[CORNERS] + 3*place[5*contact[SHAPE]+CORNERS];
  const casadi_real* to = ahead[CORNERS] + 3*place[5*contact[SHAPE]+CORNERS];
  const casadi_real* here = arg[CORNERS] + 3*(place[5*contact[OTHER_SHAPE]+CORNERS] + contact[OTHER_FEATURE]);
  const casadi_real* there = ahead[CORNERS]
    + 3*(place[5*contact[OTHER_SHAPE]+CORNERS] + contact[OTHER_FEATURE]);
  casadi_int count = 2, j, point = contact[FEATURE];
  casadi_real relative[3], height, closing, share, moved, past;
  if (arg[RADII][contact[SHAPE]]>0 || arg[RADII][contact[OTHER_SHAPE]]>0) return 0;
  if (dimension==3) {
    count = form[form[LOOP_STARTS]+contact[FEATURE]+1] - form[form[LOOP_STARTS]+contact[FEATURE]];
    point = form[form[LOOP_CORNERS]+form[form[LOOP_STARTS]+contact[FEATURE]]];
  }
  casadi_between(from + 3*point, here, relative);
  height = casadi_dot(normal, relative);
  share = sqrt(casadi_dot(relative, relative));
  casadi_between(to + 3*point, there, relative);
  closing = arg[LIMITS][LEAD]*(height - casadi_dot(turned, relative));
  if (!(height>0 && closing>arg[SHARES][AT_REST]*share && height<arg[SHARES][LATEST]*closing)) return 0;
  share = height/closing + arg[SHARES][CORNER_SLACK];
  for (j=0; j<count; ++j) {
    past = casadi_beyond(form, from, normal, contact[FEATURE], j, dimension, here);
    moved = arg[LIMITS][LEAD]*(casadi_beyond(form, to, turned, contact[FEATURE], j, dimension, there) - past);
    if (moved>0 && past + share*moved>0) return 1;
  }
  return 0;
}
